//! `leafbrdf convert`: a measurement file in another form.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use leafbrdf::measurement::{Azimuth, Layout, Quantity, ReadOptions, WriteOptions, read_path, write_path};

use super::Failure;

/// Convert a measurement file between layouts, quantities and azimuth conventions
///
/// What is not asked to change stays as it is in IN. Files whose names end in .gz are compressed. Every rule of
/// measurement files is checked on the way, so this is also the way to check one: `leafbrdf convert leaf.csv - > /dev/null`.
#[derive(Args)]
#[command(after_help = "Example:
  leafbrdf convert laurel.csv laurel-long.csv.gz --layout long --to-quantity brdf")]
pub struct Arguments {
    /// Measurement file, wide or long, plain or gzip; - is standard input
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// File to write; - is standard output
    #[arg(value_name = "OUT")]
    output: PathBuf,
    /// Quantity of IN, where it does not say: π·BRDF (brf) or sr⁻¹ (brdf)
    #[arg(long, value_enum)]
    quantity: Option<Quantity>,
    /// Azimuth convention of IN, where it does not say
    #[arg(long, value_enum)]
    azimuth: Option<Azimuth>,
    /// Layout of OUT: one column a direction, or one row a value
    #[arg(long, value_enum)]
    layout: Option<Layout>,
    /// Quantity of OUT
    #[arg(long, value_enum, value_name = "QUANTITY")]
    to_quantity: Option<Quantity>,
    /// Azimuth convention of OUT
    #[arg(long, value_enum, value_name = "AZIMUTH")]
    to_azimuth: Option<Azimuth>,
    /// Of several leaves in IN, the one to write
    #[arg(long, value_name = "NAME")]
    sample: Option<String>,
    /// Leave the column of standard deviations out
    #[arg(long)]
    without_sd: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = ReadOptions { quantity: arguments.quantity, azimuth: arguments.azimuth };
    let mut leaves = read_path(&arguments.input, &options)?;
    if let Some(name) = &arguments.sample {
        let names: Vec<String> = leaves.iter().map(|leaf| leaf.name.clone()).collect();
        leaves.retain(|leaf| leaf.name == *name);
        if leaves.is_empty() {
            let message = format!("no sample {name:?}; the file has {}", names.join(", "));
            return Err(Failure::Failed(format!("{}: {message}", arguments.input.display())));
        }
    }
    let mut errors = io::stderr().lock();
    for leaf in &mut leaves {
        if arguments.without_sd {
            leaf.sd = None;
        }
        let counts = leaf.counts();
        // Messages are a courtesy here: where standard error is closed, the conversion still is what was asked for.
        let _ = writeln!(
            errors,
            "{}: {} bands, {} directions, {} values, {} missing, {} negative",
            leaf.name,
            leaf.wavelengths_nm.len(),
            leaf.directions.len(),
            counts.usable,
            counts.missing,
            counts.negative
        );
        if let Some(warning) = leaf.azimuth_warning() {
            let _ = writeln!(errors, "warning: {warning}");
        }
    }
    let form =
        WriteOptions { layout: arguments.layout, quantity: arguments.to_quantity, azimuth: arguments.to_azimuth };
    Ok(write_path(&arguments.output, &leaves, &form)?)
}
