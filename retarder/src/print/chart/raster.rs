//! Braille dots: two columns and four rows in each character.

/// Grid of characters for dots and marks.
pub(super) struct Raster<L> {
    width: usize,
    height: usize,
    cells: Vec<Cell<L>>,
}

#[derive(Clone)]
struct Cell<L> {
    dots: u8,
    mark: Option<char>,
    layer: Option<L>,
}

/// Dots of a character, across and down.
pub(super) const DOTS: [usize; 2] = [2, 4];

/// Bit of the dot in column and row of a character (Unicode braille patterns).
const BITS: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

impl<L: Copy> Raster<L> {
    /// Creates an empty grid; sizes in characters.
    pub(super) fn new(width: usize, height: usize) -> Self {
        let cell = Cell {
            dots: 0,
            mark: None,
            layer: None,
        };
        Self {
            width,
            height,
            cells: vec![cell; width * height],
        }
    }

    /// Sets a dot; (0, 0) is at the top left. Dots outside are not drawn.
    fn dot(&mut self, x: isize, y: isize, layer: L) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else {
            return;
        };
        let (column, row) = (x / DOTS[0], y / DOTS[1]);
        if column < self.width && row < self.height {
            let cell = &mut self.cells[row * self.width + column];
            cell.dots |= BITS[x % DOTS[0]][y % DOTS[1]];
            cell.layer = Some(layer);
        }
    }

    /// Draws a straight line between two dots (Bresenham).
    pub(super) fn line(&mut self, from: (isize, isize), to: (isize, isize), layer: L) {
        let (dx, dy) = ((to.0 - from.0).abs(), -(to.1 - from.1).abs());
        let (step_x, step_y) = ((to.0 - from.0).signum(), (to.1 - from.1).signum());
        let (mut x, mut y) = from;
        let mut error = dx + dy;
        loop {
            self.dot(x, y, layer);
            if (x, y) == to {
                return;
            }
            let doubled = 2 * error;
            if doubled >= dy {
                error += dy;
                x += step_x;
            }
            if doubled <= dx {
                error += dx;
                y += step_y;
            }
        }
    }

    /// Draws a character in place of the dots of its cell.
    pub(super) fn mark(&mut self, x: isize, y: isize, mark: char, layer: L) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else {
            return;
        };
        let (column, row) = (x / DOTS[0], y / DOTS[1]);
        if column < self.width && row < self.height {
            let cell = &mut self.cells[row * self.width + column];
            (cell.mark, cell.layer) = (Some(mark), Some(layer));
        }
    }

    /// Returns the characters of a row, each with the layer that was drawn last; `empty` for empty cells.
    pub(super) fn row(
        &self,
        row: usize,
        empty: char,
    ) -> impl Iterator<Item = (char, Option<L>)> + '_ {
        self.cells[row * self.width..][..self.width]
            .iter()
            .map(move |cell| {
                let character = match (cell.mark, cell.dots) {
                    (Some(mark), _) => mark,
                    (None, 0) => empty,
                    (None, dots) => char::from_u32(0x2800 + u32::from(dots)).unwrap_or(empty),
                };
                (character, cell.layer)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(raster: &Raster<()>) -> Vec<String> {
        (0..raster.height)
            .map(|row| {
                raster
                    .row(row, ' ')
                    .map(|(character, _)| character)
                    .collect()
            })
            .collect()
    }

    #[test]
    fn lines_are_dots_from_end_to_end_in_every_direction() {
        let mut raster = Raster::new(2, 1);
        raster.line((0, 0), (3, 3), ());
        assert_eq!(text(&raster), ["⠑⢄"]);
        let mut backwards = Raster::new(2, 1);
        backwards.line((3, 3), (0, 0), ());
        assert_eq!(text(&backwards), ["⠑⢄"]);
        let mut upright = Raster::new(1, 2);
        upright.line((1, 7), (1, 0), ());
        assert_eq!(text(&upright), ["⢸", "⢸"]);
    }

    #[test]
    fn what_is_outside_is_not_drawn() {
        let mut raster = Raster::new(1, 1);
        raster.line((-5, -5), (-1, 9), ());
        raster.mark(2, 0, 'x', ());
        assert_eq!(text(&raster), [" "]);
        raster.mark(1, 3, 'x', ());
        assert_eq!(text(&raster), ["x"]);
    }
}
