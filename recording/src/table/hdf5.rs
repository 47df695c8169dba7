//! MATLAB files of version 7.3 and other HDF5 files: numeric datasets, also in groups.

use std::panic::{AssertUnwindSafe, catch_unwind};

use hdf5_pure::{DType, Dataset, Error, File, Group};

use super::Limits;
use super::columns::{Budget, Columns, NumberColumn};
use super::error::{Located, damaged};
use super::numeric::{PATH_BYTES_MAX, add_array, header_of};

/// Nesting of groups beyond which nothing is read; links may form a loop.
const DEPTH_MAX: usize = 8;
/// Groups in which MATLAB keeps objects.
const OWN_GROUPS: [&str; 2] = ["#refs#", "#subsystem#"];

/// Returns the columns of a file.
pub(super) fn columns(bytes: Vec<u8>, limits: Limits) -> Result<Columns, Located> {
    let is_matlab = bytes.starts_with(b"MATLAB");
    let producer = bytes.get(..116).filter(|_| is_matlab);
    let producer = producer.map(|text| {
        let text = String::from_utf8_lossy(text);
        text.trim_end_matches(['\0', ' ']).to_owned()
    });
    // The library counts bytes of the file as it finds them; a damaged one may lead it beyond its own checks.
    let found = catch_unwind(AssertUnwindSafe(|| {
        let length = bytes.len() as u64;
        let file = File::from_bytes(bytes).map_err(damaged)?;
        let end = file.superblock().eof_address;
        if end > length {
            return Err(damaged(format_args!("it has {length} of {end} bytes")));
        }
        let mut finder = Finder {
            columns: Vec::new(),
            budget: Budget::new(limits),
        };
        finder.add_group(&file.root(), "", 0)?;
        Ok(finder.columns)
    }));
    Ok(Columns {
        layout: match is_matlab {
            true => "MATLAB v7.3".to_owned(),
            false => "HDF5".to_owned(),
        },
        producer,
        columns: found.unwrap_or_else(|_| Err(damaged("the place cannot be found")))?,
    })
}

struct Finder {
    columns: Vec<NumberColumn>,
    budget: Budget,
}

impl Finder {
    fn add_group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), Located> {
        let inside = |name: &str| match path {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        for name in group.datasets().map_err(damaged)? {
            self.budget.check_columns(self.columns.len())?;
            let path = inside(&name);
            if path.len() > PATH_BYTES_MAX {
                return Err(damaged("a name has more than 256 bytes"));
            }
            match group.dataset(&name) {
                Ok(dataset) => self.add_dataset(&dataset, &path)?,
                Err(error) => self.refuse(&path, &error),
            }
        }
        for name in group.groups().map_err(damaged)? {
            self.budget.check_columns(self.columns.len())?;
            if OWN_GROUPS.contains(&name.as_str()) {
                continue;
            }
            let path = inside(&name);
            match group.group(&name) {
                _ if depth == DEPTH_MAX || path.len() > PATH_BYTES_MAX => {
                    let reason = "groups are nested more than eight deep";
                    self.columns.push(column(&path, Err(reason.to_owned())));
                }
                Ok(group) => self.add_group(&group, &path, depth + 1)?,
                Err(error) => self.refuse(&path, &error),
            }
        }
        Ok(())
    }

    fn add_dataset(&mut self, dataset: &Dataset, path: &str) -> Result<(), Located> {
        let attributes = dataset.attrs().map_err(damaged)?;
        let text = |name: &str| attributes.get(name).and_then(|value| value.as_str());
        let class = text("MATLAB_class").unwrap_or("");
        let obstacle = match class {
            _ if attributes.contains_key("MATLAB_empty") => Some("it is empty"),
            "char" | "string" => Some("a text"),
            "cell" => Some("a cell array"),
            "function_handle" => Some("a function"),
            "" | "double" | "single" | "logical" | "int8" | "int16" | "int32" | "int64"
            | "uint8" | "uint16" | "uint32" | "uint64" => match dataset.dtype().map_err(damaged)? {
                DType::F32
                | DType::F64
                | DType::I8
                | DType::I16
                | DType::I32
                | DType::I64
                | DType::U8
                | DType::U16
                | DType::U32
                | DType::U64 => None,
                DType::String | DType::VariableLengthString => Some("texts"),
                DType::ObjectReference => Some("an array of structures or cells"),
                DType::Compound(_) => Some("complex numbers or records"),
                DType::Enum(_) => Some("names of an enumeration"),
                _ => Some("a type that is no number"),
            },
            _ => Some(
                "an object such as a timetable or timeseries; save its times and data as arrays",
            ),
        };
        if let Some(reason) = obstacle {
            self.columns.push(column(path, Err(reason.to_owned())));
            return Ok(());
        }
        let shape = dataset.shape().map_err(damaged)?;
        let count = shape
            .iter()
            .fold(1_u64, |all, &one| all.saturating_mul(one));
        self.budget.take_values(count)?;
        if let Some(chunk) = dataset.chunk_shape().map_err(damaged)? {
            let values = chunk
                .iter()
                .fold(8_u64, |all, &one| all.saturating_mul(one));
            self.budget.check_unpacked(values)?;
        }
        let values = dataset.read_f64().map_err(damaged)?;
        if values.len() as u64 != count {
            return Err(damaged(
                "a dataset has another number of values than its shape",
            ));
        }
        // The numbers vary fastest along the last dimension of HDF5, which is the first one of MATLAB.
        let dimensions: Vec<u64> = shape.into_iter().rev().collect();
        let begin = self.columns.len();
        add_array(
            &mut self.columns,
            path,
            &header_of(path),
            &dimensions,
            values,
        );
        let unit = text("unit").or_else(|| text("units"));
        for column in &mut self.columns[begin..] {
            column.unit = unit.unwrap_or("").trim().to_owned();
        }
        self.budget.check_columns(self.columns.len())
    }

    fn refuse(&mut self, path: &str, error: &Error) {
        self.columns.push(column(path, Err(error.to_string())));
    }
}

fn column(path: &str, numbers: Result<Vec<f64>, String>) -> NumberColumn {
    NumberColumn::new(path, &header_of(path), numbers)
}
