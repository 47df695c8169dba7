//! Numeric arrays of MATLAB and HDF5: a vector is one column, a matrix several.

use super::columns::NumberColumn;

/// Longest name that is built from structures (bytes).
pub(super) const PATH_BYTES_MAX: usize = 256;

/// Adds the columns of an array. `dimensions` are those of MATLAB, and its numbers vary fastest along the first one.
pub(super) fn add_array(
    columns: &mut Vec<NumberColumn>,
    path: &str,
    header: &str,
    dimensions: &[u64],
    numbers: Vec<f64>,
) {
    let long: Vec<usize> = dimensions
        .iter()
        .filter(|&&length| length != 1)
        .map(|&length| length as usize)
        .collect();
    let refused = |reason: &str| NumberColumn::new(path, header, Err(reason.to_owned()));
    match long[..] {
        [] => columns.push(refused("a single value")),
        [_] if numbers.is_empty() => columns.push(refused("it is empty")),
        [_] => columns.push(NumberColumn::new(path, header, Ok(numbers))),
        [rows, width] if rows > 0 && width > 0 => {
            // The samples are along the longer side.
            let is_upright = rows >= width;
            let count = rows.min(width);
            for index in 0..count {
                let values = match is_upright {
                    true => numbers[index * rows..(index + 1) * rows].to_vec(),
                    false => numbers.iter().copied().skip(index).step_by(rows).collect(),
                };
                let place = match is_upright {
                    true => format!("(:,{})", index + 1),
                    false => format!("({},:)", index + 1),
                };
                let names = [path, header].map(|name| format!("{name}{place}"));
                columns.push(NumberColumn::new(&names[0], &names[1], Ok(values)));
            }
        }
        [_, _] => columns.push(refused("it is empty")),
        _ => columns.push(refused("an array of more than two dimensions")),
    }
}

/// Returns the name of a variable without its structures: `log.p_ch.values` is `p_ch`.
pub(super) fn header_of(path: &str) -> String {
    let mut parts = path.rsplit('.');
    let is_value = |part: &str| matches!(part, "values" | "Values" | "data" | "Data");
    let last = parts.next().unwrap_or(path);
    let named = match parts.next() {
        Some(parent) if is_value(last) => parent,
        _ => last,
    };
    named.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(dimensions: &[u64], numbers: &[f64]) -> Vec<(String, Option<Vec<f64>>)> {
        let mut columns = Vec::new();
        add_array(&mut columns, "log.a", "a", dimensions, numbers.to_vec());
        columns
            .into_iter()
            .map(|column| (column.key, column.numbers.ok()))
            .collect()
    }

    #[test]
    fn samples_are_along_the_longer_side_of_a_matrix() {
        let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let name = |place: &str| format!("log.a{place}");
        assert_eq!(
            shown(&[3, 2], &numbers),
            [
                (name("(:,1)"), Some(vec![1.0, 2.0, 3.0])),
                (name("(:,2)"), Some(vec![4.0, 5.0, 6.0]))
            ]
        );
        assert_eq!(
            shown(&[2, 3], &numbers),
            [
                (name("(1,:)"), Some(vec![1.0, 3.0, 5.0])),
                (name("(2,:)"), Some(vec![2.0, 4.0, 6.0]))
            ]
        );
        assert_eq!(
            shown(&[1, 2], &[1.0, 2.0]),
            [(name(""), Some(vec![1.0, 2.0]))]
        );
        assert_eq!(shown(&[1, 1], &[1.0]), [(name(""), None)]);
        assert_eq!(shown(&[0, 0], &[]), [(name(""), None)]);
        assert_eq!(shown(&[2, 1, 3, 2], &[0.0; 12]), [(name(""), None)]);
    }

    #[test]
    fn a_variable_is_named_without_its_structures() {
        assert_eq!(header_of("log.p_ch.values"), "p_ch");
        assert_eq!(header_of("log.signals(2).values"), "signals(2)");
        assert_eq!(header_of("p_ch"), "p_ch");
    }
}
