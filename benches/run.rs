//! Whole runs: how many simulated seconds of the flat, mapped from the first motion to the written map, one second
//! of one core holds. `cargo bench --bench run`, about twenty seconds; the best of three runs of each seed.

use periplus::runtime::Stopwatch;
use std::error::Error;
use std::path::Path;
use std::process::{Command, Stdio};

const WORLD: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/sims/flat.toml");
const SEEDS: u32 = 5;
const RUNS: u32 = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("periplus-bench-{}", std::process::id()));
    let measured = measure(&folder);
    // What is left behind is in the way of nobody but itself.
    let _ = std::fs::remove_dir_all(&folder);
    let mut ratios = measured?;
    ratios.sort_by(f64::total_cmp);
    println!("median {:.0} simulated seconds a second", ratios[ratios.len() / 2]);
    Ok(())
}

/// Simulated seconds a second, for each seed.
fn measure(folder: &Path) -> Result<Vec<f64>, Box<dyn Error>> {
    println!(
        "flat, calibrated, lean, alpha 0.25\nseed   simulated s   seconds   simulated s a second"
    );
    let mut ratios = Vec::new();
    for seed in 1..=SEEDS {
        let (mut best, mut simulated) = (f64::INFINITY, 0.0);
        for run in 0..RUNS {
            let out = folder.join(format!("{seed}-{run}"));
            let watch = Stopwatch::start();
            let status = Command::new(env!("CARGO_BIN_EXE_periplus"))
                .args(["run", "--world", WORLD, "--noise", "calibrated", "--plan", "lean"])
                .args(["--alpha", "0.25", "--seed", &seed.to_string(), "--out"])
                .arg(&out)
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status()?;
            best = best.min(watch.seconds());
            if !status.success() {
                return Err(format!("the run of seed {seed} ended with {status}").into());
            }
            simulated = simulated_seconds(&out.join("report.json"))?;
        }
        println!("{seed:4} {simulated:13.0} {best:9.3} {:22.0}", simulated / best);
        ratios.push(simulated / best);
    }
    Ok(ratios)
}

fn simulated_seconds(report: &Path) -> Result<f64, Box<dyn Error>> {
    let report: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(report)?)?;
    let phases = report["phases"].as_array().ok_or("a report without phases")?;
    Ok(phases.iter().filter_map(|phase| phase["simulated_s"].as_f64()).sum())
}
