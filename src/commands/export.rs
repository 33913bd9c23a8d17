//! `periplus export`: hands over one result of a finished run under another name.

use super::CommandError;
use crate::cli::{ArgumentError, ExportArgs, ExportFormat};
use crate::runtime::folder::write_whole;

/// Writes the result that was asked for.
///
/// # Errors
/// When the folder holds no such result, or the file cannot be written.
pub fn export(args: &ExportArgs) -> Result<u8, CommandError> {
    let name = match args.format {
        ExportFormat::Geojson => "map.geojson",
        ExportFormat::Json => "map.json",
        ExportFormat::Svg => "map.svg",
        ExportFormat::Png => "map.png",
        ExportFormat::Ros => {
            return Err(ArgumentError::absent(
                "`--format ros`",
                "write geojson, json, svg or png instead",
            )
            .into());
        }
    };
    let path = args.dir.join(name);
    let bytes = std::fs::read(&path).map_err(|error| {
        let hint = if args.dir.join("journal").exists() {
            "the run has not ended there; its record is whole, its results were never written"
        } else {
            "name the --out folder of a finished run"
        };
        CommandError::Input(format!("{}: {error}; {hint}", path.display()))
    })?;
    write_whole(&args.out, &bytes)?;
    Ok(0)
}
