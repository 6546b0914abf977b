//! The inputs of a model command: the product of lists on the command line, or the rows of a file.

use std::path::Path;

use leafbrdf::points::Points;
use leafbrdf_core::DomainError;

use super::Failure;
use super::list::List;

/// One input of a command, and how the user spells it.
pub struct Input<'a> {
    /// The name of its column.
    pub column: &'static str,
    /// The name of its option, with the dashes.
    pub flag: &'static str,
    /// Its name in the model, as [`DomainError`] has it.
    pub parameter: &'static str,
    /// What the command line says.
    pub list: Option<&'a List>,
    /// Its value where neither a list nor a column gives one; `None`: it must be given.
    pub default: Option<f64>,
}

impl<'a> Input<'a> {
    pub fn new(
        column: &'static str,
        flag: &'static str,
        parameter: &'static str,
        list: Option<&'a List>,
        default: Option<f64>,
    ) -> Self {
        Input { column, flag, parameter, list, default }
    }
}

/// Rows of numbers, one number an input.
pub struct Inputs<'a> {
    inputs: Vec<Input<'a>>,
    rows: Rows,
}

enum Rows {
    /// All combinations of the lists, the last list running fastest.
    Product(Vec<Vec<f64>>),
    /// The file, and the column of each input.
    Points(Points, Vec<Option<usize>>),
}

impl<'a> Inputs<'a> {
    /// From a file of points, where there is one, else from the lists.
    pub fn new(points: Option<&Path>, inputs: Vec<Input<'a>>) -> Result<Self, Failure> {
        let rows = match points {
            Some(path) => {
                let points = Points::read(path)?;
                let column = |input: &Input<'_>| match input.default {
                    Some(_) => points.find(input.column),
                    None => points.require(input.column).map(Some),
                };
                let columns = inputs.iter().map(column).collect::<Result<_, _>>()?;
                Rows::Points(points, columns)
            }
            None => {
                let list = |input: &Input<'_>| match (input.list, input.default) {
                    (Some(List(numbers)), _) => Ok(numbers.clone()),
                    (None, Some(default)) => Ok(vec![default]),
                    (None, None) => {
                        Err(Failure::Usage(format!("{} is missing: expected it, or --points FILE", input.flag)))
                    }
                };
                Rows::Product(inputs.iter().map(list).collect::<Result<_, _>>()?)
            }
        };
        Ok(Inputs { inputs, rows })
    }

    /// Calls `evaluate` for every row. The first error of the model is told with its place: the option, or line and column.
    pub fn for_each<E>(&self, mut evaluate: impl FnMut(&[f64]) -> Result<(), E>) -> Result<(), Failure>
    where
        RowError: From<E>,
    {
        let mut row = vec![0.0; self.inputs.len()];
        match &self.rows {
            Rows::Product(lists) => {
                let count = lists.iter().map(|list| list.len() as u128).product::<u128>();
                for index in 0..count {
                    let mut rest = index;
                    for (value, list) in row.iter_mut().zip(lists).rev() {
                        let length = list.len() as u128;
                        *value = list.get((rest % length) as usize).copied().unwrap_or(f64::NAN);
                        rest /= length;
                    }
                    evaluate(&row).map_err(|error| self.of_flag(RowError::from(error), &row))?;
                }
            }
            Rows::Points(points, columns) => {
                for index in 0..points.len() {
                    for ((value, column), input) in row.iter_mut().zip(columns).zip(&self.inputs) {
                        *value = match column {
                            Some(column) => points.number(index, *column)?,
                            None => input.default.unwrap_or(f64::NAN),
                        };
                    }
                    evaluate(&row).map_err(|error| match RowError::from(error) {
                        RowError::Domain(error) => match self.place(error).and_then(|place| *columns.get(place)?) {
                            Some(column) => points.error(index, column, &format!("expected {}", error.expected)).into(),
                            None => Failure::Failed(error.to_string()),
                        },
                        RowError::Failure(failure) => failure,
                    })?;
                }
            }
        }
        Ok(())
    }

    /// Which input an error of the model speaks of.
    fn place(&self, error: DomainError) -> Option<usize> {
        self.inputs.iter().position(|input| input.parameter == error.parameter)
    }

    fn of_flag(&self, error: RowError, row: &[f64]) -> Failure {
        match error {
            RowError::Failure(failure) => failure,
            RowError::Domain(error) => {
                let place = self.place(error).and_then(|place| Some((self.inputs.get(place)?.flag, row.get(place)?)));
                Failure::Usage(match place {
                    Some((flag, value)) => format!("{flag}: found {value}: expected {}", error.expected),
                    None => error.to_string(),
                })
            }
        }
    }
}

/// A row as an array, for naming its numbers.
pub fn fixed<const WIDTH: usize>(row: &[f64]) -> [f64; WIDTH] {
    let mut fixed = [f64::NAN; WIDTH];
    fixed.iter_mut().zip(row).for_each(|(to, from)| *to = *from);
    fixed
}

/// What may go wrong with a row.
pub enum RowError {
    /// An input outside its domain.
    Domain(DomainError),
    /// Anything else.
    Failure(Failure),
}

impl From<DomainError> for RowError {
    fn from(error: DomainError) -> Self {
        RowError::Domain(error)
    }
}

impl From<Failure> for RowError {
    fn from(failure: Failure) -> Self {
        RowError::Failure(failure)
    }
}
