//! The reader of measurement files: never a panic, every refusal names the file, and what is accepted comes back from what
//! is written of it.

use leafbrdf::measurement::{
    Azimuth, Layout, Measurement, Quantity, ReadError, ReadOptions, WriteError, WriteOptions, read_bytes, render,
};

use crate::Input;

/// `read_bytes` on the input as it is, and with options taken from its first byte on the rest; plain or gzip.
pub fn readers(data: &[u8]) {
    check(data, &ReadOptions::default());
    let mut input = Input::new(data);
    let choice = input.byte();
    let options = ReadOptions {
        quantity: [None, Some(Quantity::Brf), Some(Quantity::Brdf)][usize::from(choice) % 3],
        azimuth: [None, Some(Azimuth::Forward180), Some(Azimuth::Forward0)][usize::from(choice / 3) % 3],
    };
    check(input.rest(), &options);
}

fn check(bytes: &[u8], options: &ReadOptions) {
    let name = "leaf.csv";
    let leaves = match read_bytes(name, bytes, options) {
        Ok(leaves) => leaves,
        Err(error) => return one_sentence(name, &error),
    };
    assert!(!leaves.is_empty(), "a file without a leaf was accepted");
    for leaf in &leaves {
        sane(leaf);
    }
    for layout in [Layout::Wide, Layout::Long] {
        for azimuth in [None, Some(Azimuth::Forward180), Some(Azimuth::Forward0)] {
            round_trip(&leaves, WriteOptions { layout: Some(layout), quantity: None, azimuth });
        }
    }
}

/// A refusal names the file and is one sentence.
pub(crate) fn one_sentence(name: &str, error: &ReadError) {
    let message = error.to_string();
    assert!(message.starts_with(name), "does not name the file: {message}");
    assert!(!error.message.is_empty() && !message.contains('\n'), "not one sentence: {message:?}");
}

/// What every accepted measurement satisfies.
fn sane(leaf: &Measurement) {
    let cells = leaf.wavelengths_nm.len() * leaf.directions.len();
    assert!(cells > 0 && leaf.values.len() == cells, "one value a wavelength and direction");
    assert!(leaf.wavelengths_nm.is_sorted_by(|a, b| a < b), "wavelengths ascend, each once");
    assert!(leaf.wavelengths_nm.iter().all(|nm| *nm > 0.0 && nm.is_finite()));
    for direction in &leaf.directions {
        assert!((0.0..90.0).contains(&direction.theta_s_deg), "{direction:?}");
        assert!((0.0..90.0).contains(&direction.theta_v_deg), "{direction:?}");
        assert!(direction.phi_v_deg.abs() <= 360.0, "{direction:?}");
    }
    assert!(leaf.values.iter().all(|value| !value.is_infinite()), "a number or missing");
    let counts = leaf.counts();
    assert!(counts.usable > 0 && counts.usable + counts.missing == cells && counts.negative <= counts.usable);
    if let Some(sd) = &leaf.sd {
        assert_eq!(sd.len(), cells);
        // 0 says that there was no noise: a fit that weights by it refuses it, a conversion keeps it
        assert!(sd.iter().all(|sd| sd.is_nan() || *sd >= 0.0), "standard deviations are not negative, or missing");
    }
}

/// What is written can be read, says the same, and is then written the same.
fn round_trip(leaves: &[Measurement], options: WriteOptions) {
    let text = match render(leaves, &options) {
        Ok(text) => text,
        Err(WriteError::Unfit(why)) => {
            // the wide layout cannot hold several leaves or standard deviations; the long one holds whatever was read
            let wide = options.layout == Some(Layout::Wide);
            assert!(wide && (leaves.len() > 1 || leaves[0].sd.is_some()), "refused to write what was read: {why}");
            return;
        }
        Err(error) => panic!("{error}"),
    };
    let again = match read_bytes("leaf.csv", text.as_bytes(), &ReadOptions::default()) {
        Ok(again) => again,
        Err(error) => panic!("written and not readable: {error}\n{text}"),
    };
    assert_eq!(again.len(), leaves.len());
    for (before, after) in leaves.iter().zip(&again) {
        assert_eq!((&before.sample, before.quantity), (&after.sample, after.quantity));
        assert_eq!(before.metadata, after.metadata);
        assert_eq!(before.wavelengths_nm, after.wavelengths_nm);
        assert_eq!(before.directions.len(), after.directions.len());
        for (a, b) in before.directions.iter().zip(&after.directions) {
            assert_eq!((a.theta_s_deg, a.theta_v_deg), (b.theta_s_deg, b.theta_v_deg));
            // the other convention may spell an azimuth with another turn, and adding 180° rounds
            let turns = (a.phi_v_deg - b.phi_v_deg) / 360.0;
            assert!((turns - turns.round()).abs() < 1e-14, "{a:?} came back as {b:?}");
        }
        assert!(same(&before.values, &after.values), "{:?} and {:?}", before.values, after.values);
        assert_eq!(before.sd.is_some(), after.sd.is_some());
        if let (Some(before), Some(after)) = (&before.sd, &after.sd) {
            assert!(same(before, after), "{before:?} and {after:?}");
        }
    }
    if leaves.iter().all(|leaf| options.azimuth.is_none_or(|azimuth| azimuth == leaf.azimuth)) {
        let text_again = render(&again, &options).expect("it could be written before");
        assert_eq!(text, text_again, "written twice, the same");
    }
}

/// The same bits, any NaN standing for any other.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
}
