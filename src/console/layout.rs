//! Where the regions of the screen lie. A pure function of the size: the view draws by it and
//! `update` pans and zooms by it.

use ratatui::layout::Rect;

/// The least width that can be worked in, cells.
pub const MIN_COLS: u16 = 60;
/// The least height that can be worked in, cells.
pub const MIN_ROWS: u16 = 16;

/// The regions, drawn in `view`'s documentation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Regions {
    /// What runs, how, how fast and since when; one row.
    pub header: Rect,
    /// The four phases; one or two rows.
    pub phases: Rect,
    /// The rule between phases and body, which holds the titles of map and panel.
    pub top_rule: Rect,
    /// The map.
    pub map: Rect,
    /// The rule between map and panel, one column.
    pub side_rule: Rect,
    /// The figures.
    pub panel: Rect,
    /// The rule above the log, which holds its title.
    pub log_rule: Rect,
    /// The log.
    pub log: Rect,
    /// Keys or remarks; one row.
    pub footer: Rect,
    /// Whether the log stands below the panel instead of below everything.
    pub log_at_side: bool,
}

impl Regions {
    /// The regions of a screen of `cols` by `rows`; none when that is too small to work in.
    #[must_use]
    pub fn of(cols: u16, rows: u16) -> Option<Self> {
        if cols < MIN_COLS || rows < MIN_ROWS {
            return None;
        }
        let phase_rows = if rows >= 34 { 2 } else { 1 };
        let log_at_side = cols >= 150 && rows >= 44;
        let panel_cols = match cols {
            190.. => 64,
            150.. => 50,
            110.. => 38,
            76.. => 29,
            _ => 25,
        };
        let log_rows = if log_at_side {
            rows / 3
        } else {
            match rows {
                34.. => rows / 5,
                22.. => 5,
                _ => 3,
            }
        };
        let top = 2 + phase_rows;
        let bottom = rows - 1;
        let map_cols = cols - panel_cols - 1;
        let log_top = bottom - log_rows;
        let body_end = log_top - 1;
        let map_end = if log_at_side { bottom } else { body_end };
        let log_x = if log_at_side { map_cols + 1 } else { 0 };
        Some(Self {
            header: Rect::new(0, 0, cols, 1),
            phases: Rect::new(0, 1, cols, phase_rows),
            top_rule: Rect::new(0, top - 1, cols, 1),
            map: Rect::new(0, top, map_cols, map_end - top),
            side_rule: Rect::new(map_cols, top, 1, map_end - top),
            panel: Rect::new(map_cols + 1, top, panel_cols, body_end - top),
            log_rule: Rect::new(log_x, body_end, cols - log_x, 1),
            log: Rect::new(log_x, log_top, cols - log_x, log_rows),
            footer: Rect::new(0, bottom, cols, 1),
            log_at_side,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_tile_the_screen_at_every_size() {
        for cols in (MIN_COLS..=300).step_by(7) {
            for rows in MIN_ROWS..=100 {
                let regions = Regions::of(cols, rows).unwrap();
                let all = [
                    regions.header,
                    regions.phases,
                    regions.top_rule,
                    regions.map,
                    regions.side_rule,
                    regions.panel,
                    regions.log_rule,
                    regions.log,
                    regions.footer,
                ];
                let covered: u32 = all.iter().map(|region| region.area()).sum();
                assert_eq!(
                    covered,
                    u32::from(cols) * u32::from(rows),
                    "{cols}x{rows}: regions overlap or leave holes: {regions:?}"
                );
                assert!(regions.map.width >= 30 && regions.map.height >= 6, "{cols}x{rows}");
            }
        }
        assert_eq!(Regions::of(MIN_COLS - 1, 50), None);
        assert_eq!(Regions::of(100, MIN_ROWS - 1), None);
    }
}
