//! The map as ROS reads it: a grid of free, occupied and unknown cells as a PGM picture, with a YAML
//! file that says where it lies (the format of ROS' `map_server`).
//!
//! Occupied is every cell that a surface passes through, or that lies behind one in an object; free is the
//! floor within the boundary; everything beyond the walls is unknown, since nobody was there.

use super::native::MapFile;
use crate::geometry::raster::{Grid, inside};
use crate::geometry::{Point, Ring, Segment, Vector};

/// Pitch of the grid, metres: finer than the 5 cm of lidar maps, since touch is.
const CELL: f64 = 0.02;
/// Unknown cells around it, metres.
const MARGIN: f64 = 0.2;
/// A picture of more cells is none.
const MOST_CELLS: f64 = 1e8;
/// Arcs are cut into chords within this, metres.
const SAGITTA: f64 = 0.001;

/// Grey of the three kinds of cells.
const FREE: u8 = 254;
const OCCUPIED: u8 = 0;
const UNKNOWN: u8 = 205;

/// The two files of a ROS map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RosMap {
    /// Text of the YAML file.
    pub yaml: String,
    /// The picture, PGM (P5), first row at the top.
    pub pgm: Vec<u8>,
}

/// Why there is no ROS map of a map.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RosError {
    /// Nobody has been round yet.
    #[error("the boundary is not closed; a ROS map needs an inside and an outside")]
    Open,
    /// Such a picture would fill the memory.
    #[error(
        "a boundary of {width:.0} by {height:.0} m makes a picture of more than 100 million cells; \
         is the file damaged? `--format geojson` has no such limit"
    )]
    TooLarge {
        /// Extent in x, metres.
        width: f64,
        /// Extent in y, metres.
        height: f64,
    },
}

/// The ROS map of `map`, whose picture will be called `image`.
///
/// # Errors
/// While the boundary is open, and when it is too large for a picture.
pub fn write(map: &MapFile, image: &str) -> Result<RosMap, RosError> {
    let boundary = map.boundary.as_ref().ok_or(RosError::Open)?.ring();
    let objects: Vec<Ring> = map.objects.iter().map(|object| object.outline.ring()).collect();
    let (low, high) = boundary.bounds().ok_or(RosError::Open)?;
    let [width, height] = [high.x - low.x, high.y - low.y];
    // The other way round a size that is no number would pass.
    let fits = (width + 2.0 * MARGIN) * (height + 2.0 * MARGIN) <= MOST_CELLS * CELL * CELL;
    if !fits {
        return Err(RosError::TooLarge { width, height });
    }
    let grid = Grid::over(low, high, CELL, MARGIN);
    let mut cells = vec![UNKNOWN; grid.len()];
    let walls = segments(&boundary);
    paint(&mut cells, &inside(&grid, &walls), FREE);
    let mut surfaces = walls;
    for object in &objects {
        let outline = segments(object);
        paint(&mut cells, &inside(&grid, &outline), OCCUPIED);
        surfaces.extend(outline);
    }
    paint(&mut cells, &touched(&grid, &surfaces), OCCUPIED);
    Ok(RosMap { yaml: yaml(image, &grid), pgm: pgm(&grid, &cells) })
}

fn segments(ring: &Ring) -> Vec<Segment> {
    crate::geometry::segment::chords(ring, SAGITTA)
}

/// Every cell that a surface passes through: a beam that is cast from cell to cell, slantwise as well, meets a
/// wall wherever it runs.
fn touched(grid: &Grid, surfaces: &[Segment]) -> Vec<bool> {
    let mut cells = vec![false; grid.len()];
    // In cells, from the outer corner of the first.
    let place = |point: Point| (point - grid.origin) / CELL + Vector::repeat(0.5);
    // What lies beyond the picture is left out.
    let within = |from: f64, to: f64, count: usize| {
        from.floor().max(0.0) as usize..(to.floor() + 1.0).clamp(0.0, count as f64) as usize
    };
    for surface in surfaces {
        let (mut low, mut high) = (place(surface.from), place(surface.to()));
        if low.y > high.y {
            (low, high) = (high, low);
        }
        let x_at = |y: f64| match y {
            y if y <= low.y => low.x,
            y if y >= high.y => high.x,
            y => low.x + (high.x - low.x) * (y - low.y) / (high.y - low.y),
        };
        for row in within(low.y, high.y, grid.height) {
            let (one, other) = (x_at(row as f64), x_at(row as f64 + 1.0));
            for column in within(one.min(other), one.max(other), grid.width) {
                cells[row * grid.width + column] = true;
            }
        }
    }
    cells
}

fn paint(cells: &mut [u8], mask: &[bool], grey: u8) {
    for (cell, _) in cells.iter_mut().zip(mask).filter(|(_, on)| **on) {
        *cell = grey;
    }
}

fn yaml(image: &str, grid: &Grid) -> String {
    // The origin is the lower left corner of the lower left cell.
    let Point { coords, .. } = grid.origin;
    let (x, y) = (coords.x - CELL / 2.0, coords.y - CELL / 2.0);
    let image = scalar(image);
    format!(
        "image: {image}\nresolution: {CELL}\norigin: [{x:.4}, {y:.4}, 0.0]\nnegate: 0\n\
         occupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
}

/// A name as YAML takes it: as it is where nothing in it means something there, else in quotes, in which YAML
/// reads what JSON does.
fn scalar(name: &str) -> String {
    let plain = |letter: char| letter.is_alphanumeric() || matches!(letter, '.' | '_' | '-');
    if name.starts_with(char::is_alphanumeric) && name.chars().all(plain) {
        return name.to_owned();
    }
    serde_json::Value::from(name).to_string()
}

fn pgm(grid: &Grid, cells: &[u8]) -> Vec<u8> {
    let mut bytes = format!("P5\n{} {}\n255\n", grid.width, grid.height).into_bytes();
    for row in cells.chunks(grid.width).rev() {
        bytes.extend_from_slice(row);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::super::native::Outline;
    use super::super::sample;
    use super::*;

    /// Grey at a place, read back as `map_server` would.
    fn grey(map: &RosMap, x: f64, y: f64) -> u8 {
        let origin = map.yaml.lines().find(|line| line.starts_with("origin")).expect("an origin");
        let numbers: Vec<f64> = origin
            .trim_start_matches("origin: [")
            .trim_end_matches(']')
            .split(", ")
            .map(|number| number.parse().expect("a number"))
            .collect();
        let header = String::from_utf8_lossy(&map.pgm[..20]).into_owned();
        let size: Vec<usize> =
            header.split_whitespace().skip(1).take(2).map(|n| n.parse().expect("size")).collect();
        let (column, row) =
            (((x - numbers[0]) / CELL) as usize, ((y - numbers[1]) / CELL) as usize);
        let picture = &map.pgm[map.pgm.len() - size[0] * size[1]..];
        picture[(size[1] - 1 - row) * size[0] + column]
    }

    #[test]
    fn floor_is_free_walls_and_objects_are_occupied_and_beyond_nobody_knows() {
        let file = MapFile::of(&sample::room().record());
        let map = write(&file, "room.pgm").expect("closed");
        assert!(map.yaml.starts_with("image: room.pgm\nresolution: 0.02\n"), "{}", map.yaml);
        assert_eq!(grey(&map, 0.5, 0.5), FREE);
        assert_eq!(grey(&map, 0.001, 1.5), OCCUPIED, "the left wall");
        assert_eq!(grey(&map, 2.65, 0.95), OCCUPIED, "inside the box");
        // The upper right corner is rounded off.
        assert_eq!(grey(&map, 3.95, 2.95), UNKNOWN);
        assert_eq!(grey(&map, -0.1, 1.5), UNKNOWN);
    }

    /// What casts beams from cell to cell goes slantwise as well, between two cells that meet in a corner.
    #[test]
    fn no_slanted_wall_has_a_hole() {
        let mut file = MapFile::of(&sample::room().record());
        file.boundary = Some(Outline::Circle { circle: [0.013, 0.007, 1.503] });
        let map = write(&file, "room.pgm").expect("closed");
        let cell = |x: i32, y: i32| grey(&map, f64::from(x) * CELL, f64::from(y) * CELL);
        let mut holes = 0;
        let all = (-80..80).flat_map(|x| (-80..80).map(move |y| (x, y)));
        for (x, y) in all.filter(|&(x, y)| cell(x, y) == FREE) {
            let around = (-1..=1).flat_map(|a| (-1..=1).map(move |b| (x + a, y + b)));
            holes += around.filter(|&(x, y)| cell(x, y) == UNKNOWN).count();
        }
        assert_eq!(holes, 0, "free floor next to what nobody saw");
    }

    #[test]
    fn a_picture_of_any_name_is_found_again() {
        let file = MapFile::of(&sample::room().record());
        for (name, written) in [
            ("room-2.pgm", "room-2.pgm"),
            ("Küche.pgm", "Küche.pgm"),
            ("a b: #1.pgm", "\"a b: #1.pgm\""),
            ("a\"b\\c.pgm", "\"a\\\"b\\\\c.pgm\""),
            ("- a.pgm", "\"- a.pgm\""),
            ("-a.pgm", "\"-a.pgm\""),
            ("[a].pgm", "\"[a].pgm\""),
        ] {
            let yaml = write(&file, name).expect("closed").yaml;
            assert!(yaml.starts_with(&format!("image: {written}\n")), "{yaml}");
        }
    }

    #[test]
    fn an_open_boundary_makes_no_map() {
        let mut sample = sample::room();
        sample.map.closed = false;
        assert_eq!(write(&MapFile::of(&sample.record()), "room.pgm"), Err(RosError::Open));
    }

    #[test]
    fn a_boundary_that_is_too_large_is_no_picture() {
        let mut file = MapFile::of(&sample::room().record());
        for size in [1e4, 1e9, 1e308] {
            file.boundary = Some(Outline::Circle { circle: [0.0, 0.0, size] });
            let error = write(&file, "room.pgm").expect_err("it cannot be held");
            assert!(error.to_string().contains("damaged"), "{error}");
        }
    }
}
