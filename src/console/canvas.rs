//! A grid of braille dots, two by four to a cell, with one style role a cell. Owns which dots
//! are set: lines are clipped here, and everything painted merges (dots are OR-ed) in a single
//! pass, the role of the higher rank winning the cell. Knows nothing of maps or colours.
//!
//! ```text
//! bits of a cell   0x01 0x08      U+2800 + bits is the symbol
//!                  0x02 0x10
//!                  0x04 0x20
//!                  0x40 0x80
//! ```

pub mod viewport;

use super::theme::{Role, Theme};
use crate::geometry::{Point, Ring, angle};
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use viewport::{DOTS_X, DOTS_Y, Viewport};

/// Which dots of a line are set, so that lines differ without colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pattern {
    /// Every dot.
    Solid,
    /// One dot in `n`.
    Sparse(u16),
    /// The first `on` dots of every `of`.
    Dash {
        /// Dots set.
        on: u16,
        /// Dots in all.
        of: u16,
    },
}

impl Pattern {
    /// No dots are set but at multiples of this.
    fn stride(self) -> i64 {
        match self {
            Self::Sparse(n) => i64::from(n.max(1)),
            Self::Solid | Self::Dash { .. } => 1,
        }
    }

    fn sets(self, step: i64) -> bool {
        match self {
            Self::Solid => true,
            Self::Sparse(n) => step % i64::from(n.max(1)) == 0,
            Self::Dash { on, of } => step % i64::from(of.max(1)) < i64::from(on),
        }
    }

    /// So many cells of a level line, as the map draws it.
    #[must_use]
    pub fn sample(self, cells: u16) -> String {
        let cell = |cell: i64| {
            let dot = |step: i64, bit: u8| if self.sets(step) { bit } else { 0 };
            match dot(2 * cell, 0x04) | dot(2 * cell + 1, 0x20) {
                0 => ' ',
                bits => symbol(bits),
            }
        };
        (0..i64::from(cells)).map(cell).collect()
    }
}

/// The dots of one frame of the map.
#[derive(Debug, Clone)]
pub struct Canvas {
    view: Viewport,
    /// Dots to a metre, and where the map frame's origin falls, in dots: [`Viewport::to_dots`] without
    /// its divisions.
    dense: f64,
    origin: (f64, f64),
    width: i32,
    height: i32,
    /// The dots of each cell, and the role it is shown in.
    cells: Vec<(u8, Role)>,
}

impl Canvas {
    /// An empty grid that shows `view`.
    #[must_use]
    pub fn new(view: Viewport) -> Self {
        let cells = usize::from(view.cols) * usize::from(view.rows);
        let dense = 1.0 / view.scale;
        Self {
            view,
            dense,
            origin: view.to_dots(Point::origin()),
            width: i32::from(view.cols) * i32::from(DOTS_X),
            height: i32::from(view.rows) * i32::from(DOTS_Y),
            cells: vec![(0, Role::Text); cells],
        }
    }

    /// What the grid shows.
    #[must_use]
    pub fn view(&self) -> &Viewport {
        &self.view
    }

    fn dots_of(&self, p: Point) -> (f64, f64) {
        (self.origin.0 + p.x * self.dense, self.origin.1 - p.y * self.dense)
    }

    /// Sets the dot that shows `p`, if it is in view.
    pub fn point(&mut self, p: Point, role: Role) {
        let (x, y) = self.dots_of(p);
        self.dot_at(x, y, role);
    }

    /// A straight line from `a` to `b`. The pattern is counted from `a`, in view or not, so it
    /// stands still when the view moves along the line.
    pub fn line(&mut self, a: Point, b: Point, role: Role, pattern: Pattern) {
        self.segment(self.dots_of(a), self.dots_of(b), role, pattern);
    }

    /// Lines from each point to the next. Points that fall on the dot of the one before are
    /// passed over, so long tracks cost no more than their dots.
    pub fn polyline(&mut self, points: impl IntoIterator<Item = Point>, role: Role) {
        let mut last: Option<((f64, f64), (i32, i32))> = None;
        for p in points {
            let here = self.dots_of(p);
            let dot = (whole(here.0), whole(here.1));
            if let Some((before, old)) = last {
                let apart = (dot.0.abs_diff(old.0)).max(dot.1.abs_diff(old.1));
                match apart {
                    0 => continue,
                    1 => self.set(dot.0, dot.1, role),
                    _ => self.segment(before, here, role, Pattern::Solid),
                }
            } else {
                self.dot_at(here.0, here.1, role);
            }
            last = Some((here, dot));
        }
    }

    /// A closed outline, its arcs cut finely enough for the dots.
    pub fn ring(&mut self, ring: &Ring, role: Role) {
        let points = ring.to_points(self.sagitta());
        self.polyline(points.iter().chain(points.first()).copied(), role);
    }

    /// How far a chord may stray from its arc before a dot would show it, metres.
    #[must_use]
    pub fn sagitta(&self) -> f64 {
        (self.view.scale / 3.0).max(1e-4)
    }

    /// The rim of a disc of `radius` metres.
    pub fn circle(&mut self, center: Point, radius: f64, role: Role, pattern: Pattern) {
        let dots = radius / self.view.scale;
        if !dots.is_finite() || !self.may_show(center, radius) {
            return;
        }
        let steps = (dots * angle::TAU).ceil().clamp(8.0, 4096.0);
        for step in 0..steps as i64 {
            if pattern.sets(step) {
                let toward = angle::unit(angle::TAU * step as f64 / steps);
                self.point(center + toward * radius, role);
            }
        }
    }

    /// A filled disc of `radius` metres; at least its middle dot.
    pub fn disc(&mut self, center: Point, radius: f64, role: Role) {
        self.each_dot_within(center, radius, |grid, x, y| grid.set(x, y, role));
        self.point(center, role);
    }

    /// Clears every dot within `radius` metres, to let what is painted next stand free.
    pub fn clear_disc(&mut self, center: Point, radius: f64) {
        self.each_dot_within(center, radius, Self::clear);
    }

    /// Clears the cells within `radius` metres whose role ranks below `from`.
    pub fn clear_background(&mut self, center: Point, radius: f64, from: Role) {
        self.each_dot_within(center, radius, |grid, x, y| {
            if let Some((cell, _)) = grid.place(x, y)
                && grid.cells[cell].1 < from
            {
                grid.clear(x, y);
            }
        });
    }

    /// What the cell shows; nothing where it has no dots or is out of view.
    #[must_use]
    pub fn shows(&self, col: u16, row: u16) -> Option<Role> {
        if col >= self.view.cols || row >= self.view.rows {
            return None;
        }
        let cell = usize::from(row) * usize::from(self.view.cols) + usize::from(col);
        let (dots, role) = self.cells[cell];
        (dots != 0).then_some(role)
    }

    /// Writes the cells that have dots to the upper left of `area`.
    pub fn blit(&self, theme: &Theme, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        for row in 0..area.height.min(self.view.rows) {
            let start = usize::from(row) * usize::from(self.view.cols);
            for col in 0..area.width.min(self.view.cols) {
                let (bits, role) = self.cells[start + usize::from(col)];
                if bits == 0 {
                    continue;
                }
                let symbol = symbol(bits);
                let style = theme.style(role);
                buf[(area.x + col, area.y + row)].set_char(symbol).set_style(style);
            }
        }
    }

    fn may_show(&self, center: Point, radius: f64) -> bool {
        let away = center - self.view.center;
        away.x.abs() <= self.view.x_range() / 2.0 + radius
            && away.y.abs() <= self.view.y_range() / 2.0 + radius
    }

    fn each_dot_within(
        &mut self,
        center: Point,
        radius: f64,
        mut act: impl FnMut(&mut Self, i32, i32),
    ) {
        let (x, y) = self.dots_of(center);
        let reach = radius / self.view.scale;
        if !(x.is_finite() && y.is_finite() && reach.is_finite()) {
            return;
        }
        let span = |middle: f64, end: i32| {
            let low = (middle - reach).floor().clamp(0.0, f64::from(end));
            let high = (middle + reach).ceil().clamp(0.0, f64::from(end));
            low as i32..high as i32
        };
        for j in span(y, self.height) {
            for i in span(x, self.width) {
                let (dx, dy) = (f64::from(i) + 0.5 - x, f64::from(j) + 0.5 - y);
                if dx * dx + dy * dy <= reach * reach {
                    act(self, i, j);
                }
            }
        }
    }

    fn segment(&mut self, a: (f64, f64), b: (f64, f64), role: Role, pattern: Pattern) {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let Some((enter, leave)) = self.clip(a, (dx, dy)) else {
            return;
        };
        let steps = dx.abs().max(dy.abs()).ceil().max(1.0);
        let (first, last) = ((enter * steps).floor() as i64, (leave * steps).ceil() as i64);
        let stride = pattern.stride();
        let mut step = first.div_euclid(stride) * stride;
        while step <= last {
            if step >= first && pattern.sets(step) {
                let t = (step as f64 / steps).clamp(enter, leave);
                self.dot_at(a.0 + dx * t, a.1 + dy * t, role);
            }
            step += stride;
        }
    }

    /// The shares of a line at which it enters and leaves the grid (Liang and Barsky); none when
    /// it misses it or is not finite.
    fn clip(&self, a: (f64, f64), (dx, dy): (f64, f64)) -> Option<(f64, f64)> {
        if !(a.0.is_finite() && a.1.is_finite() && dx.is_finite() && dy.is_finite()) {
            return None;
        }
        let (right, bottom) = (f64::from(self.width), f64::from(self.height));
        let mut span = (0.0_f64, 1.0_f64);
        for (speed, room) in [(-dx, a.0), (dx, right - a.0), (-dy, a.1), (dy, bottom - a.1)] {
            if speed == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if speed < 0.0 {
                span.0 = span.0.max(room / speed);
            } else {
                span.1 = span.1.min(room / speed);
            }
        }
        (span.0 <= span.1).then_some(span)
    }

    #[inline]
    fn dot_at(&mut self, x: f64, y: f64, role: Role) {
        if x >= 0.0 && y >= 0.0 {
            self.set(x as i32, y as i32, role);
        }
    }

    #[inline]
    fn place(&self, x: i32, y: i32) -> Option<(usize, u8)> {
        const BITS: [u8; 8] = [0x01, 0x08, 0x02, 0x10, 0x04, 0x20, 0x40, 0x80];
        // A negative number becomes a large one.
        let (x, y) = (x as u32, y as u32);
        if x >= self.width as u32 || y >= self.height as u32 {
            return None;
        }
        let cell = (y / 4) as usize * usize::from(self.view.cols) + (x / 2) as usize;
        Some((cell, BITS[(y % 4 * 2 + x % 2) as usize]))
    }

    #[inline]
    fn set(&mut self, x: i32, y: i32, role: Role) {
        if let Some((cell, bit)) = self.place(x, y) {
            let (dots, shown) = &mut self.cells[cell];
            if *dots == 0 || role > *shown {
                *shown = role;
            }
            *dots |= bit;
        }
    }

    fn clear(&mut self, x: i32, y: i32) {
        if let Some((cell, bit)) = self.place(x, y) {
            self.cells[cell].0 &= !bit;
        }
    }
}

/// The symbol that shows the dots `bits` of a cell.
fn symbol(bits: u8) -> char {
    char::from_u32(0x2800 + u32::from(bits)).unwrap_or(' ')
}

/// The whole number at or below `x`; `f64::floor` is a call on machines of the common kind.
fn whole(x: f64) -> i32 {
    let cut = x as i32;
    if f64::from(cut) > x { cut.saturating_sub(1) } else { cut }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(canvas: &Canvas) -> String {
        let area = Rect::new(0, 0, canvas.view.cols, canvas.view.rows);
        let mut buf = Buffer::empty(area);
        canvas.blit(&Theme::mono(), area, &mut buf);
        buf.content()
            .chunks(usize::from(canvas.view.cols))
            .map(|row| row.iter().map(ratatui::buffer::Cell::symbol).collect::<String>() + "\n")
            .collect()
    }

    fn grid(cols: u16, rows: u16) -> Canvas {
        let center = Point::new(f64::from(cols), f64::from(rows) * 2.0);
        Canvas::new(Viewport { center, scale: 1.0, cols, rows })
    }

    #[test]
    fn a_box_touches_the_rim_and_nothing_else() {
        let mut canvas = grid(4, 2);
        let corners = [(0.5, 0.5), (7.5, 0.5), (7.5, 7.5), (0.5, 7.5)];
        canvas.ring(&Ring::polygon(&corners.map(|(x, y)| Point::new(x, y))), Role::Wall);
        assert_eq!(picture(&canvas), "⡏⠉⠉⢹\n⣇⣀⣀⣸\n");
    }

    #[test]
    fn dots_merge_and_the_higher_role_wins_the_cell() {
        let mut canvas = grid(1, 1);
        canvas.point(Point::new(0.5, 0.5), Role::Wall);
        canvas.point(Point::new(1.5, 3.5), Role::Trajectory);
        assert_eq!(picture(&canvas), "⡈\n");
        assert_eq!(canvas.cells[0].1, Role::Wall, "the wall must keep the cell");
        canvas.clear_disc(Point::new(1.0, 2.0), 5.0);
        canvas.point(Point::new(0.5, 0.5), Role::Trajectory);
        assert_eq!(canvas.cells[0].1, Role::Trajectory, "a cleared cell forgets its role");
    }

    #[test]
    fn a_sample_is_what_a_level_line_looks_like() {
        for pattern in
            [Pattern::Solid, Pattern::Sparse(2), Pattern::Sparse(3), Pattern::Dash { on: 3, of: 5 }]
        {
            let mut canvas = grid(4, 1);
            canvas.line(Point::new(0.5, 1.5), Point::new(7.5, 1.5), Role::Wall, pattern);
            assert_eq!(picture(&canvas).trim_end_matches('\n'), pattern.sample(4), "{pattern:?}");
        }
    }

    #[test]
    fn a_disc_is_round() {
        let mut canvas = grid(4, 2);
        canvas.disc(Point::new(4.0, 4.0), 3.0, Role::Robot);
        assert_eq!(picture(&canvas), "⢠⣶⣶⡄\n⠘⠿⠿⠃\n");
    }
}
