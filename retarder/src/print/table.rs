//! Tables with a line below the head, and cells that wrap to the width of the terminal.

use comfy_table::{
    Attribute, Cell, CellAlignment, Color, ContentArrangement, ContentLineStyle, LineStyle,
    TableStyle,
};

use super::{Colour, Terminal, indented, painted_lines};

const STYLE: TableStyle = TableStyle::new()
    .header_lines(ContentLineStyle::none())
    .header_separator(LineStyle::none().fill('─').junction('─'))
    .content_lines(ContentLineStyle::none());

/// Table under construction.
pub(super) struct Table {
    table: comfy_table::Table,
    terminal: Terminal,
    wide: Vec<String>,
}

/// Placeholder for a line that is wider than a column. No text has this character.
const WIDE: &str = "\u{e000}";

/// Alignment of the cells of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Right,
}

impl Table {
    /// Creates a table with these columns.
    pub(super) fn new<const N: usize>(columns: [(&str, Align); N], terminal: &Terminal) -> Self {
        let mut table = comfy_table::Table::new();
        table
            .load_style(STYLE)
            .set_content_arrangement(ContentArrangement::Dynamic)
            .set_width(u16::try_from(terminal.width).unwrap_or(u16::MAX));
        if terminal.is_coloured {
            table.enforce_styling();
        } else {
            table.force_no_tty();
        }
        table.set_header(columns.map(|(name, _)| Cell::new(name).add_attribute(Attribute::Bold)));
        for (index, (_, align)) in columns.iter().enumerate() {
            if let Some(column) = table.column_mut(index) {
                column.set_padding((0, 1));
                column.set_cell_alignment(match align {
                    Align::Left => CellAlignment::Left,
                    Align::Right => CellAlignment::Right,
                });
            }
        }
        Self {
            table,
            terminal: *terminal,
            wide: Vec::new(),
        }
    }

    /// Adds a row.
    pub(super) fn row<const N: usize>(&mut self, cells: [Entry; N]) {
        self.table.add_row(cells.map(|entry| entry.0));
    }

    /// Adds a title between the rows.
    pub(super) fn heading(&mut self, text: &str) {
        self.wide(self.terminal.paint(Colour::Title, text));
    }

    /// Adds a remark below a row.
    pub(super) fn remark(&mut self, text: &str) {
        let text = painted_lines(
            Colour::Faint,
            &indented(text, 4, &self.terminal),
            &self.terminal,
        );
        self.wide(text.trim_end().to_owned());
    }

    fn wide(&mut self, text: String) {
        self.wide.push(text);
        self.table.add_row([WIDE]);
    }
}

impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut wide = self.wide.iter();
        for line in self.table.lines() {
            if line.contains(WIDE) {
                writeln!(f, "{}", wide.next().map_or("", String::as_str))?;
            } else {
                writeln!(f, "{}", line.trim_end())?;
            }
        }
        Ok(())
    }
}

/// Cell of a table.
pub(super) struct Entry(Cell);

impl<T: ToString> From<T> for Entry {
    fn from(content: T) -> Self {
        Self(Cell::new(content))
    }
}

/// Creates a cell in the colour of its meaning.
pub(super) fn painted(colour: Colour, text: impl ToString) -> Entry {
    let cell = Cell::new(text);
    Entry(match colour {
        Colour::Title => cell.add_attribute(Attribute::Bold),
        Colour::Good => cell.fg(Color::DarkGreen),
        Colour::Bad => cell.fg(Color::DarkRed).add_attribute(Attribute::Bold),
        Colour::Notice | Colour::Second => cell.fg(Color::DarkYellow),
        Colour::Faint => cell.add_attribute(Attribute::Dim),
        Colour::First => cell.fg(Color::DarkCyan),
    })
}

/// Creates a cell with the verdict in a word.
pub(super) fn verdict(holds: Option<bool>) -> Entry {
    match holds {
        Some(true) => painted(Colour::Good, "pass"),
        Some(false) => painted(Colour::Bad, "FAIL"),
        None => painted(Colour::Faint, "-"),
    }
}

/// Blocks in steps of one eighth.
const EIGHTHS: [char; 9] = [' ', '▏', '▎', '▍', '▌', '▋', '▊', '▉', '█'];

/// Returns a bar of `share` (0 to 1) of `width` characters.
pub(super) fn bar(share: f64, width: usize) -> String {
    let eighths = (share.clamp(0.0, 1.0) * (8 * width) as f64).round() as usize;
    let mut bar = "█".repeat(eighths / 8);
    if !eighths.is_multiple_of(8) {
        bar.push(EIGHTHS[eighths % 8]);
    }
    bar
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_no_wider_than_the_terminal() {
        let terminal = Terminal {
            width: 40,
            is_coloured: false,
        };
        let mut table = Table::new([("name", Align::Left), ("value", Align::Right)], &terminal);
        table.row([
            "a long text that needs more than one line of the table".into(),
            1.5.into(),
        ]);
        table.heading("a heading of 39 characters, in one line");
        let text = table.to_string();
        assert!(text.lines().count() > 4, "{text}");
        assert!(
            text.ends_with("a heading of 39 characters, in one line\n"),
            "{text}"
        );
        assert!(
            text.lines().all(|line| line.chars().count() <= 40),
            "{text}"
        );
    }

    #[test]
    fn a_bar_has_the_length_of_its_share() {
        assert_eq!(bar(1.0, 4), "████");
        assert_eq!(bar(0.5, 4), "██");
        assert_eq!(bar(-0.1, 4), "");
        assert_eq!(bar(7.0, 2), "██");
        assert_eq!(bar(3.0 / 32.0, 4), "▍");
    }
}
