//! What is written is read back, and conversions lose nothing.

use proptest::prelude::*;

use leafbrdf::measurement::{
    Azimuth, Direction, Layout, Measurement, Metadata, Quantity, ReadOptions, WriteOptions, read_bytes, read_path,
    render, write_path,
};

/// A name without blanks around it and without control characters.
const NAME: &str = "[A-Za-z0-9_ä\"',;:#/-]([A-Za-z0-9_ä\"',;:#/ -]{0,8}[A-Za-z0-9_ä\"',;:#/-])?";

prop_compose! {
    fn direction()(theta_s_deg in zenith(), theta_v_deg in zenith(), phi_v_deg in azimuth()) -> Direction {
        Direction { theta_s_deg, theta_v_deg, phi_v_deg }
    }
}

/// Round angles as in files, and any double.
fn zenith() -> impl Strategy<Value = f64> {
    prop_oneof![(0..9000_i32).prop_map(|hundredth| f64::from(hundredth) / 100.0), 0.0..90.0]
}

fn azimuth() -> impl Strategy<Value = f64> {
    (-36000..=36000_i32).prop_map(|hundredth| f64::from(hundredth) / 100.0)
}

fn value() -> impl Strategy<Value = f64> {
    prop_oneof![
        5 => (-100..20000_i32).prop_map(|v| f64::from(v) / 1e5),
        3 => -0.01..3.0,
        1 => (any::<f64>()).prop_map(|x| x % 1.0),
        1 => Just(f64::NAN),
    ]
}

fn metadata() -> impl Strategy<Value = Metadata> {
    let entry =
        prop_oneof![("(species|face|source|leaf age|Lux)", NAME), (Just(String::new()), "[a-z][a-z ]{0,8}[a-z]")];
    prop::collection::vec(entry, 0..4).prop_map(|entries| {
        let mut metadata = Metadata::new();
        entries
            .into_iter()
            .filter(|(_, value)| !value.starts_with("//"))
            .for_each(|(key, value)| metadata.push(key, value));
        metadata
    })
}

prop_compose! {
    fn measurement()(
        directions in prop::collection::vec(direction(), 1..8),
        wavelengths in prop::collection::btree_set(10_000..250_000_u32, 1..8),
        quantity in prop_oneof![Just(Quantity::Brf), Just(Quantity::Brdf)],
        layout in prop_oneof![Just(Layout::Wide), Just(Layout::Long)],
        metadata in metadata(),
        sample in prop::option::of(NAME),
    )(
        mut values in prop::collection::vec(value(), directions.len() * wavelengths.len()),
        sd in prop::option::of(prop::collection::vec(0.0..0.1, directions.len() * wavelengths.len())),
        directions in Just(directions), wavelengths in Just(wavelengths), quantity in Just(quantity),
        layout in Just(layout), metadata in Just(metadata), sample in Just(sample),
    ) -> Measurement {
        values[0] = 0.25;
        let mut seen = std::collections::HashSet::new();
        let distinct = directions.iter().all(|d| {
            let phi = d.phi_v_deg.rem_euclid(360.0);
            seen.insert([d.theta_s_deg, d.theta_v_deg, phi].map(|angle| (angle + 0.0).to_bits()))
        });
        let directions = if distinct { directions } else {
            (0..directions.len()).map(|i| Direction { theta_s_deg: 30.0, theta_v_deg: i as f64, phi_v_deg: 180.0 }).collect()
        };
        Measurement {
            name: sample.clone().unwrap_or("leaf".to_string()),
            sample, metadata, quantity, layout,
            azimuth: Azimuth::Forward180,
            wavelengths_nm: wavelengths.into_iter().map(|hundredth| f64::from(hundredth) / 100.0).collect(),
            directions, values,
            sd: sd.filter(|_| layout == Layout::Long),
        }
    }
}

/// Equal to the bit, NaN equal to NaN.
fn same(a: &Measurement, b: &Measurement) -> Result<(), TestCaseError> {
    let bits = |values: &[f64]| {
        values.iter().map(|v| if v.is_nan() { f64::NAN.to_bits() } else { v.to_bits() }).collect::<Vec<_>>()
    };
    prop_assert_eq!(bits(&a.values), bits(&b.values));
    prop_assert_eq!(a.sd.as_deref().map(bits), b.sd.as_deref().map(bits));
    let without = |m: &Measurement| Measurement { values: Vec::new(), sd: None, ..m.clone() };
    prop_assert_eq!(without(a), without(b));
    Ok(())
}

fn through(measurements: &[Measurement], options: WriteOptions) -> Vec<Measurement> {
    let text = render(measurements, &options).unwrap();
    read_bytes("leaf.csv", text.as_bytes(), &ReadOptions::default()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read_back(leaf in measurement()) {
        let back = through(std::slice::from_ref(&leaf), WriteOptions::default());
        prop_assert_eq!(back.len(), 1);
        same(&back[0], &leaf)?;
    }

    #[test]
    fn the_way_through_the_other_layout_loses_nothing(leaf in measurement()) {
        let leaf = Measurement { sd: None, ..leaf };
        let other = if leaf.layout == Layout::Wide { Layout::Long } else { Layout::Wide };
        let there = through(std::slice::from_ref(&leaf), WriteOptions { layout: Some(other), ..WriteOptions::default() });
        let back = through(&there, WriteOptions { layout: Some(leaf.layout), ..WriteOptions::default() });
        same(&back[0], &leaf)?;
    }

    #[test]
    fn the_way_through_the_other_azimuth_convention_loses_nothing(leaf in measurement()) {
        let there = through(std::slice::from_ref(&leaf), WriteOptions { azimuth: Some(Azimuth::Forward0), ..WriteOptions::default() });
        let back = through(&there, WriteOptions { azimuth: Some(Azimuth::Forward180), ..WriteOptions::default() });
        let circle = |m: &Measurement| m.directions.iter().map(|d| d.phi_v_deg.rem_euclid(360.0)).collect::<Vec<_>>();
        for (a, b) in circle(&back[0]).iter().zip(circle(&leaf)) {
            // Hundredths of a degree are the same number again; adding 360 to a negative one may round.
            prop_assert!((a - b).abs() < 1e-13);
        }
        let directions = leaf.directions.clone();
        same(&Measurement { directions, ..back[0].clone() }, &leaf)?;
    }

    #[test]
    fn several_leaves_in_one_file_are_read_back(a in measurement(), b in measurement()) {
        let as_sample = |m: Measurement, name: &str, metadata: &Metadata| Measurement {
            name: name.to_string(), sample: Some(name.to_string()), layout: Layout::Long, sd: None,
            metadata: metadata.clone(), ..m.into_quantity(Quantity::Brf)
        };
        let metadata = a.metadata.clone();
        let leaves = [as_sample(a, "a, \"upper\"", &metadata), as_sample(b, "#b", &metadata)];
        let back = through(&leaves, WriteOptions::default());
        prop_assert_eq!(back.len(), 2);
        for (back, leaf) in back.iter().zip(&leaves) {
            same(back, leaf)?;
        }
    }

    #[test]
    fn values_of_at_most_nine_decimals_survive_brf_and_brdf(values in prop::collection::vec(-1_000_000_i64..3_000_000_000, 1..40)) {
        let values: Vec<f64> = values.into_iter().map(|v| v as f64 / 1e9).collect();
        let leaf = Measurement {
            name: "leaf".to_string(), sample: None, metadata: Metadata::new(), quantity: Quantity::Brf,
            layout: Layout::Wide, azimuth: Azimuth::Forward180, wavelengths_nm: vec![500.0],
            directions: (0..values.len()).map(|i| Direction { theta_s_deg: 30.0, theta_v_deg: i as f64, phi_v_deg: 0.0 }).collect(),
            values, sd: None,
        };
        let there = through(std::slice::from_ref(&leaf), WriteOptions { quantity: Some(Quantity::Brdf), ..WriteOptions::default() });
        for (brdf, brf) in there[0].values.iter().zip(&leaf.values) {
            // Two roundings of half a unit in the last place, and the short neighbour's one.
            prop_assert!((brdf * std::f64::consts::PI - brf).abs() <= 6e-16 * brf.abs());
        }
        let back = through(&there, WriteOptions { quantity: Some(Quantity::Brf), ..WriteOptions::default() });
        same(&back[0], &leaf)?;
    }

    #[test]
    fn any_quantity_comes_back_within_two_units_in_the_last_place(leaf in measurement()) {
        let other = if leaf.quantity == Quantity::Brf { Quantity::Brdf } else { Quantity::Brf };
        let back = leaf.clone().into_quantity(other).into_quantity(leaf.quantity);
        for (a, b) in back.values.iter().zip(&leaf.values).filter(|(a, _)| !a.is_nan()) {
            // Multiplication and division round by half a unit each, relative 1.1e-16; subnormal numbers by 5e-324.
            prop_assert!((a - b).abs() <= 4.5e-16 * b.abs() + 1e-322, "{} {}", a, b);
        }
    }

    #[test]
    fn no_bytes_make_the_reader_panic(bytes: Vec<u8>) {
        let _ = read_bytes("any", &bytes, &ReadOptions::default());
    }

    #[test]
    fn a_file_that_is_accepted_can_be_written_and_is_read_back(
        which in 0_usize..2,
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0_usize..4, "[0-9.,\n\"#:eN -]{0,6}|brdf|forward_0|NaN|\r"), 0..6),
    ) {
        let mut text = [WIDE, LONG][which].to_string();
        for (place, removed, inserted) in edits {
            // All ASCII: every place is between two characters.
            let start = place.index(text.len().max(1)).min(text.len());
            let end = (start + removed).min(text.len());
            text.replace_range(start..end, &inserted);
        }
        if let Ok(leaves) = read_bytes("leaf.csv", text.as_bytes(), &ReadOptions::default()) {
            let back = through(&leaves, WriteOptions::default());
            prop_assert_eq!(back.len(), leaves.len());
            for (back, leaf) in back.iter().zip(&leaves) {
                // Azimuths of more than twelve decimals round when they are turned by 180°: 3e-14° each time.
                for (a, b) in leaf.directions.iter().zip(&back.directions) {
                    let apart = (a.phi_v_deg - b.phi_v_deg).abs() % 360.0;
                    prop_assert!(apart.min(360.0 - apart) < 1e-12);
                }
                same(&Measurement { directions: leaf.directions.clone(), ..back.clone() }, leaf)?;
            }
        }
    }

    #[test]
    fn the_one_pass_reader_says_what_the_csv_crate_says(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0_usize..4, "[0-9.,\n#:eN -]{0,6}|NaN|NA|\r"), 0..5),
    ) {
        let mut text = WIDE.to_string();
        for (place, removed, inserted) in edits {
            let start = place.index(text.len().max(1)).min(text.len());
            let end = (start + removed).min(text.len());
            text.replace_range(start..end, &inserted);
        }
        // A remark with a quote sends the same rows through the `csv` crate.
        let read = |remark: &str| read_bytes("leaf.csv", format!("{remark}\n{text}").as_bytes(), &ReadOptions::default());
        match (read("#"), read("# \"")) {
            (Ok(one_pass), Ok(mut csv)) => {
                csv[0].metadata = one_pass[0].metadata.clone();
                same(&one_pass[0], &csv[0])?;
            }
            (one_pass, csv) => prop_assert_eq!(one_pass.err(), csv.err()),
        }
    }

    #[test]
    fn no_text_like_a_measurement_makes_the_reader_panic(
        lines in prop::collection::vec(
            "(# quantity: brf|theta_s_deg|theta_v_deg|phi_v_deg|wavelength_nm|brf|sample|sd|[0-9.,\"#\r-]{0,12}|NaN|é)(,(theta_s_deg|theta_v_deg|phi_v_deg|brdf|sd|sample|[0-9.e\" -]{0,5}|NA)){0,6}",
            0..12,
        )
    ) {
        let text = lines.join("\n");
        for quantity in [None, Some(Quantity::Brf)] {
            let options = ReadOptions { quantity, azimuth: None };
            for leaf in read_bytes("any", text.as_bytes(), &options).unwrap_or_default() {
                prop_assert_eq!(leaf.values.len(), leaf.wavelengths_nm.len() * leaf.directions.len());
                prop_assert!(leaf.counts().usable > 0);
                prop_assert!(leaf.values.iter().all(|value| !value.is_infinite()));
                prop_assert!(leaf.directions.iter().all(|d| (0.0..90.0).contains(&d.theta_v_deg) && d.phi_v_deg.abs() <= 360.0));
                prop_assert!(leaf.wavelengths_nm.is_sorted_by(|a, b| a < b));
            }
        }
    }
}

const WIDE: &str = "# species: Acer\n# sample: a\n# azimuth: forward_0\n# quantity: brf\ntheta_s_deg,30,30\ntheta_v_deg,60,0\n\
                    phi_v_deg,180,0\n400,0.116,0.121\n401,,-0.002\n";

const LONG: &str = "# azimuth: forward_0\nwavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf,sd,sample\n400,30,60,180,0.116,0.01,a\n\
                    400,30,-0,0,0.121,,a\n401,30,60,180,0.117,0,b\n401,30,0,0,NaN,0.1,b\n";

fn example() -> Measurement {
    let file =
        b"# species: Prunus laurocerasus\n# quantity: brf\ntheta_s_deg,30,30\ntheta_v_deg,60,0\nphi_v_deg,180,0.1\n\
                 400,0.116,0.121\n400.5,,-1e-9\n";
    read_bytes("leaf.csv", file, &ReadOptions::default()).unwrap().remove(0)
}

#[test]
fn the_written_form_is_the_documented_one() {
    let leaf = example();
    let text = "# species: Prunus laurocerasus\n# quantity: brf\n# azimuth: forward_180\ntheta_s_deg,30,30\n\
                theta_v_deg,60,0\nphi_v_deg,180,0.1\n400,0.116,0.121\n400.5,,-1e-9\n";
    assert_eq!(render(std::slice::from_ref(&leaf), &WriteOptions::default()).unwrap(), text);
    let options = WriteOptions { layout: Some(Layout::Long), azimuth: Some(Azimuth::Forward0), quantity: None };
    let text = "# species: Prunus laurocerasus\n# quantity: brf\n# azimuth: forward_0\n\
                wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf\n400,30,60,0,0.116\n400,30,0,180.1,0.121\n\
                400.5,30,60,0,\n400.5,30,0,180.1,-1e-9\n";
    assert_eq!(render(&[leaf], &options).unwrap(), text);
}

#[test]
fn a_name_that_ends_in_gz_is_compressed_and_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let leaf = example();
    for name in ["leaf.csv", "leaf.csv.gz"] {
        let path = folder.path().join(name);
        write_path(&path, std::slice::from_ref(&leaf), &WriteOptions::default()).unwrap();
        let back = read_path(&path, &ReadOptions::default()).unwrap().remove(0);
        assert_eq!(back.name, "leaf");
        same(&back, &leaf).unwrap();
        assert_eq!(std::fs::read(&path).unwrap().starts_with(&[0x1f, 0x8b]), name.ends_with("gz"));
    }
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "no temporary file is left: {left:?}");
}

#[test]
fn a_form_that_cannot_hold_the_measurement_is_refused() {
    let unfit = |leaves: &[Measurement], layout| {
        render(leaves, &WriteOptions { layout: Some(layout), ..WriteOptions::default() }).unwrap_err().to_string()
    };
    let leaf = example();
    let with_sd = Measurement { sd: Some(vec![0.1; 4]), ..leaf.clone() };
    assert!(unfit(&[with_sd], Layout::Wide).contains("no place for standard deviations"));
    assert!(unfit(&[leaf.clone(), leaf.clone()], Layout::Long).contains("sample name"));
    let named = |name: &str| Measurement { sample: Some(name.to_string()), ..leaf.clone() };
    assert!(unfit(&[named("a"), named("b")], Layout::Wide).contains("one leaf"));
    assert!(unfit(&[named("a"), named("a")], Layout::Long).contains("sample"), "the same name twice");
    let mut odd = leaf.clone();
    odd.metadata.push("two\nlines", "x");
    assert!(unfit(&[odd], Layout::Wide).contains("would not be read back"));
}
