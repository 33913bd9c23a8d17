//! Which piece of the plane the map shows. Owns the one rule that keeps dots square: a single
//! scale for both axes, so `x_range / (2 cols) = y_range / (4 rows)`. Knows nothing of dots that
//! are set, nor of what is drawn.

use crate::geometry::Point;

/// Dots side by side in a cell.
pub const DOTS_X: u16 = 2;
/// Dots on top of each other in a cell.
pub const DOTS_Y: u16 = 4;
/// The finest scale, metres per dot: a robot fills a large screen.
pub const FINEST: f64 = 0.0005;
/// The coarsest scale, metres per dot: a room of a kilometre is ten dots wide.
pub const COARSEST: f64 = 100.0;

/// A rectangle of the map frame laid over a rectangle of cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewport {
    /// What the middle of the cells shows, map frame, metres.
    pub center: Point,
    /// Metres per dot, the same in x and y.
    pub scale: f64,
    /// Width in cells.
    pub cols: u16,
    /// Height in cells.
    pub rows: u16,
}

impl Viewport {
    /// A view of `cols` by `rows` cells around `center`; the scale is kept within
    /// [`FINEST`] and [`COARSEST`], and what is not finite becomes the origin or 1 cm.
    #[must_use]
    pub fn new(center: Point, scale: f64, cols: u16, rows: u16) -> Self {
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let scale = if scale.is_finite() { scale } else { 0.01 };
        Self {
            center: Point::new(finite(center.x), finite(center.y)),
            scale: scale.clamp(FINEST, COARSEST),
            cols,
            rows,
        }
    }

    /// The view that shows the box from `low` to `high` whole, with a margin of two dots.
    #[must_use]
    pub fn fit(low: Point, high: Point, cols: u16, rows: u16) -> Self {
        let room = |cells: u16, dots: u16| (f64::from(cells) * f64::from(dots) - 4.0).max(1.0);
        let scale_x = (high.x - low.x) / room(cols, DOTS_X);
        let scale_y = (high.y - low.y) / room(rows, DOTS_Y);
        Self::new(nalgebra::center(&low, &high), scale_x.max(scale_y), cols, rows)
    }

    /// Width shown, metres.
    #[must_use]
    pub fn x_range(&self) -> f64 {
        f64::from(self.cols) * f64::from(DOTS_X) * self.scale
    }

    /// Height shown, metres.
    #[must_use]
    pub fn y_range(&self) -> f64 {
        f64::from(self.rows) * f64::from(DOTS_Y) * self.scale
    }

    /// Where `p` falls, in dots from the upper left corner, x to the right and y *down*; dot
    /// (i, j) covers [i, i+1) x [j, j+1). Points outside the view fall outside the dots.
    #[must_use]
    pub fn to_dots(&self, p: Point) -> (f64, f64) {
        let half_width = f64::from(self.cols) * f64::from(DOTS_X) / 2.0;
        let half_height = f64::from(self.rows) * f64::from(DOTS_Y) / 2.0;
        (
            (p.x - self.center.x) / self.scale + half_width,
            (self.center.y - p.y) / self.scale + half_height,
        )
    }

    /// The cell that shows `p`, from the upper left; none when it is out of view.
    #[must_use]
    pub fn to_cell(&self, p: Point) -> Option<(u16, u16)> {
        let (x, y) = self.to_dots(p);
        let inside = x >= 0.0
            && y >= 0.0
            && x < f64::from(self.cols) * f64::from(DOTS_X)
            && y < f64::from(self.rows) * f64::from(DOTS_Y);
        inside.then_some((x as u16 / DOTS_X, y as u16 / DOTS_Y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_are_square_whatever_the_size() {
        for cols in [1, 2, 7, 52, 84, 300] {
            for rows in [1, 3, 14, 25, 100] {
                let view = Viewport::fit(Point::new(-1.0, 0.5), Point::new(4.0, 3.2), cols, rows);
                let dot_x = view.x_range() / (2.0 * f64::from(cols));
                let dot_y = view.y_range() / (4.0 * f64::from(rows));
                assert!(
                    (dot_x - dot_y).abs() < 1e-12 * dot_x,
                    "{cols}x{rows}: a dot is {dot_x} m wide and {dot_y} m high"
                );
                let east = view.to_dots(Point::new(1.0, 0.0)).0 - view.to_dots(Point::origin()).0;
                let north = view.to_dots(Point::origin()).1 - view.to_dots(Point::new(0.0, 1.0)).1;
                assert!(
                    (east - north).abs() < 1e-6,
                    "{cols}x{rows}: a metre is {east} dots east and {north} dots north"
                );
            }
        }
    }

    #[test]
    fn what_is_fitted_is_seen() {
        for (cols, rows) in [(8, 4), (52, 14), (84, 25), (150, 50)] {
            let (low, high) = (Point::new(-3.0, -1.0), Point::new(9.0, 2.0));
            let view = Viewport::fit(low, high, cols, rows);
            for corner in [low, high, Point::new(low.x, high.y)] {
                assert!(view.to_cell(corner).is_some(), "{corner} is out of view at {cols}x{rows}");
            }
        }
    }

    #[test]
    fn north_is_up_and_odd_numbers_are_survived() {
        let view = Viewport::new(Point::origin(), 0.01, 10, 10);
        assert!(view.to_dots(Point::new(0.0, 0.1)).1 < view.to_dots(Point::origin()).1);
        let odd = Viewport::new(Point::new(f64::NAN, 0.0), f64::INFINITY, 10, 10);
        assert_eq!(odd.center, Point::origin());
        assert_eq!(odd.to_cell(Point::new(f64::NAN, f64::INFINITY)), None);
    }
}
