//! Tables of a document that are written from the code.

/// Asserts that a document of `docs/` is `expected`, or writes it if the variable `BLESS` is set.
pub(crate) fn assert_written(name: &str, found: &str, expected: &str) {
    if std::env::var_os("BLESS").is_some() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs");
        std::fs::write(std::path::Path::new(folder).join(name), expected).unwrap();
    } else {
        for (found, expected) in found.lines().zip(expected.lines()) {
            assert_eq!(found, expected, "docs/{name}; write it with BLESS=1");
        }
        assert_eq!(found, expected, "docs/{name}; write it with BLESS=1");
    }
}

/// Returns the page with these rows in the table whose header begins like this.
pub(crate) fn with_table(page: &str, header: &str, rows: &[String]) -> String {
    let mut lines = page.lines();
    let mut text = String::new();
    for line in lines.by_ref() {
        text += &format!("{line}\n");
        if line.starts_with(header) {
            break;
        }
    }
    let columns = lines.next().expect("a table with this header");
    text += &format!("{columns}\n");
    for row in rows {
        text += &format!("{row}\n");
    }
    let rest = lines.skip_while(|line| line.starts_with('|'));
    rest.fold(text, |text, line| text + line + "\n")
}
