//! The reader of hemispherical spectra, and the inversion of what it accepts: never a panic, every refusal says why, what is
//! accepted comes back from what is written of it.

use leafbrdf::fit::{ProspectOptions, WavelengthRange, fit_prospect};
use leafbrdf::measurement::Metadata;
use leafbrdf::spectra::{LeafSpectra, spectra_from_bytes};
use leafbrdf_fit::Interval;
use leafbrdf_fit::hemispherical::Free;
use leafbrdf_prospect::{LeafParams, Parameter, Version};

use crate::Input;
use crate::readers::one_sentence;

/// `spectra_from_bytes` on the input as it is, and the inversion of leaves of few wavelengths: those of the file, and one made of
/// the input's bytes.
pub fn spectra(data: &[u8]) {
    inverted(&made_of(&mut Input::new(data)));
    let name = "oak.csv";
    let leaves = match spectra_from_bytes(name, data) {
        Ok(leaves) => leaves,
        Err(error) => return one_sentence(name, &error),
    };
    assert!(!leaves.is_empty(), "a file without a leaf was accepted");
    leaves.iter().for_each(sane);
    round_trip(&leaves);
    for leaf in leaves.iter().take(2).filter(|leaf| leaf.wavelengths_nm.len() <= 8) {
        inverted(leaf);
    }
}

/// Any numbers that a file may hold.
fn made_of(input: &mut Input<'_>) -> LeafSpectra {
    let kinds = input.byte();
    let mut wavelengths_nm: Vec<f64> = (0..1 + input.below(6)).map(|_| input.within(350.0, 2600.0)).collect();
    wavelengths_nm.sort_by(f64::total_cmp);
    wavelengths_nm.dedup();
    let count = wavelengths_nm.len();
    let mut column = |present: bool, low: f64, high: f64| {
        let value = |input: &mut Input<'_>| if input.byte() == 0 { f64::NAN } else { input.within(low, high) };
        let values: Vec<f64> = (0..count).map(|_| if present { value(input) } else { f64::NAN }).collect();
        values.iter().any(|value| !value.is_nan()).then_some(values)
    };
    LeafSpectra {
        name: "made".to_string(),
        metadata: Metadata::new(),
        reflectance: column(kinds & 1 == 0 || kinds & 2 == 0, -0.5, 1.5),
        transmittance: column(kinds & 1 == 0 || kinds & 2 != 0, -0.5, 1.5),
        reflectance_sd: column(kinds & 12 == 12, 0.0, 1.0),
        transmittance_sd: column(kinds & 12 == 12, 0.0, 1.0),
        wavelengths_nm,
    }
}

/// All columns of a leaf, in the order of [`NAMES`].
fn columns(leaf: &LeafSpectra) -> [&Option<Vec<f64>>; 4] {
    [&leaf.reflectance, &leaf.transmittance, &leaf.reflectance_sd, &leaf.transmittance_sd]
}

const NAMES: [&str; 4] = ["reflectance", "transmittance", "reflectance_sd", "transmittance_sd"];

/// What every accepted leaf satisfies.
fn sane(leaf: &LeafSpectra) {
    assert!(!leaf.name.is_empty() || leaf.wavelengths_nm.is_empty(), "a leaf has a name");
    assert!(leaf.wavelengths_nm.is_sorted_by(|a, b| a < b), "wavelengths ascend, each once");
    assert!(leaf.wavelengths_nm.iter().all(|nm| (100.0..=100_000.0).contains(nm)), "nm");
    let ranges = [(-0.5, 1.5), (-0.5, 1.5), (0.0, 1.0), (0.0, 1.0)];
    for (column, (low, high)) in columns(leaf).into_iter().zip(ranges) {
        let Some(column) = column else { continue };
        assert_eq!(column.len(), leaf.wavelengths_nm.len(), "one value a wavelength");
        assert!(column.iter().any(|value| !value.is_nan()), "a column without a value is none");
        assert!(column.iter().all(|value| value.is_nan() || (*value >= low && *value <= high)), "a fraction");
    }
    let [usable, missing, negative] = leaf.counts();
    let spectra = usize::from(leaf.reflectance.is_some()) + usize::from(leaf.transmittance.is_some());
    assert!(usable > 0 && negative <= usable && usable + missing == spectra * leaf.wavelengths_nm.len());
}

/// What is written can be read, and says the same.
fn round_trip(leaves: &[LeafSpectra]) {
    let present: Vec<usize> = (0..4).filter(|&i| leaves.iter().any(|leaf| columns(leaf)[i].is_some())).collect();
    let mut text =
        format!("sample,wavelength_nm,{}\n", present.iter().map(|&i| NAMES[i]).collect::<Vec<_>>().join(","));
    for leaf in leaves {
        for (place, nm) in leaf.wavelengths_nm.iter().enumerate() {
            text.push_str(&format!("\"{}\",{nm}", leaf.name.replace('"', "\"\"")));
            for &i in &present {
                let value = columns(leaf)[i].as_ref().map_or(f64::NAN, |column| column[place]);
                text.push_str(&if value.is_nan() { ",".to_string() } else { format!(",{value}") });
            }
            text.push('\n');
        }
    }
    // the name of a leaf without a column `sample` may be one that no cell can hold: blanks around it, control characters
    let plain = |name: &str| name.trim() == name && !name.chars().any(char::is_control);
    let distinct =
        leaves.iter().map(|leaf| &leaf.name).collect::<std::collections::BTreeSet<_>>().len() == leaves.len();
    // an sd whose spectrum has no value left is a column without its spectrum
    let whole = |i: usize| present.contains(&i) <= present.contains(&(i - 2));
    if !(distinct && leaves.iter().all(|leaf| plain(&leaf.name)) && whole(2) && whole(3)) {
        return;
    }
    let again = match spectra_from_bytes("oak.csv", text.as_bytes()) {
        Ok(again) => again,
        Err(error) => panic!("written and not readable: {error}\n{text}"),
    };
    assert_eq!(again.len(), leaves.len());
    for (before, after) in leaves.iter().zip(&again) {
        assert_eq!((&before.name, &before.wavelengths_nm), (&after.name, &after.wavelengths_nm));
        for (a, b) in columns(before).into_iter().zip(columns(after)) {
            let bits = |column: &Option<Vec<f64>>| {
                let all = |column: &Vec<f64>| -> Vec<Option<u64>> {
                    column.iter().map(|x| (!x.is_nan()).then_some(x.to_bits())).collect()
                };
                column.as_ref().map(all)
            };
            assert_eq!(bits(a), bits(b), "the same bits");
        }
    }
}

/// A fit, or a sentence that says why there is none; parameters inside their bounds, finite, and with an error or the reason why not.
fn inverted(leaf: &LeafSpectra) {
    let free = vec![
        Free { parameter: Parameter::NStruct, bounds: Interval::new(1.0, 3.5) },
        Free { parameter: Parameter::Cab, bounds: Interval::new(0.0, 120.0) },
        Free { parameter: Parameter::Cm, bounds: Interval::new(0.0, 0.03) },
    ];
    let options = ProspectOptions {
        version: Version::D,
        free: free.clone(),
        held: LeafParams { cw: 0.01, ..LeafParams::with_n_struct(1.5) },
        car_per_cab: Some(0.25),
        n_prior: leaf.transmittance.is_none(),
        wavelengths: Some(WavelengthRange { first: 300.0, last: 3000.0, step: None }),
        use_sd: true,
    };
    let outcome = match fit_prospect(leaf, &options) {
        Ok(outcome) => outcome,
        Err(failure) => {
            let message = failure.to_string();
            assert!(!message.is_empty() && !message.contains('\n'), "not one sentence: {message:?}");
            return;
        }
    };
    assert!(outcome.rmse.is_finite() && outcome.rmse >= 0.0, "rmse = {}", outcome.rmse);
    for estimate in &outcome.fit.estimates {
        let bounds = free.iter().find(|free| free.parameter == estimate.parameter).expect("what was free").bounds;
        let value = estimate.value;
        assert!(value >= bounds.lower && value <= bounds.upper, "{estimate:?} outside {bounds:?}");
        assert!(estimate.standard_error.is_none_or(|error| error >= 0.0 && error.is_finite()), "{estimate:?}");
        let reason = estimate.why_no_error().is_some();
        assert!(estimate.standard_error.is_some() || reason, "neither an error nor the reason: {estimate:?}");
    }
    assert!(!outcome.line().contains("NaN"), "{}", outcome.line());
}
