//! Each rule of measurement files, with the message that a user sees when it is broken.

use std::io::Write;

use leafbrdf::measurement::{Azimuth, Counts, Layout, Measurement, Quantity, ReadOptions, read_bytes};

const WIDE: &str = "\
# species: Prunus laurocerasus
# quantity: brf
theta_s_deg,30,30,30
theta_v_deg,60,50,0
phi_v_deg,180,180,0
400,0.116,0.121,0.045
401,0.117,0.122,0.044
";

const LONG: &str = "\
wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf
400,30,60,180,0.116
400,30,50,180,0.121
401,30,60,180,0.117
401,30,50,180,0.122
";

fn read(file: impl AsRef<[u8]>) -> Result<Vec<Measurement>, String> {
    read_with(file, ReadOptions::default())
}

fn read_with(file: impl AsRef<[u8]>, options: ReadOptions) -> Result<Vec<Measurement>, String> {
    read_bytes("leaf.csv", file.as_ref(), &options).map_err(|error| error.to_string())
}

#[track_caller]
fn one(file: impl AsRef<[u8]>) -> Measurement {
    let mut leaves = read(file).unwrap();
    assert_eq!(leaves.len(), 1);
    leaves.remove(0)
}

/// The file is refused, and the message has all of these parts.
#[track_caller]
fn refused(file: impl AsRef<[u8]>, parts: &[&str]) {
    refused_with(file, ReadOptions::default(), parts);
}

#[track_caller]
fn refused_with(file: impl AsRef<[u8]>, options: ReadOptions, parts: &[&str]) {
    let message = read_with(file, options).expect_err("the file should be refused");
    for part in parts {
        assert!(message.contains(part), "no {part:?} in: {message}");
    }
    assert!(message.starts_with("leaf.csv"), "no file name in: {message}");
    assert!(!message.contains('\n'), "more than one line: {message}");
}

/// The wide example with one piece replaced.
#[track_caller]
fn wide(from: &str, to: &str) -> String {
    assert!(WIDE.contains(from));
    WIDE.replacen(from, to, 1)
}

#[track_caller]
fn long(from: &str, to: &str) -> String {
    assert!(LONG.contains(from));
    LONG.replacen(from, to, 1)
}

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

// What is read.

#[test]
fn the_wide_example_is_read() {
    let leaf = one(WIDE);
    assert_eq!((leaf.name.as_str(), leaf.quantity, leaf.layout), ("leaf", Quantity::Brf, Layout::Wide));
    assert_eq!(leaf.wavelengths_nm, [400.0, 401.0]);
    assert_eq!(leaf.values, [0.116, 0.121, 0.045, 0.117, 0.122, 0.044]);
    let angles: Vec<_> = leaf.directions.iter().map(|d| (d.theta_s_deg, d.theta_v_deg, d.phi_v_deg)).collect();
    assert_eq!(angles, [(30.0, 60.0, 180.0), (30.0, 50.0, 180.0), (30.0, 0.0, 0.0)]);
    assert_eq!(leaf.brdf()[0], 0.116 / std::f64::consts::PI);
    assert_eq!(leaf.metadata.get("species"), Some("Prunus laurocerasus"));
    assert_eq!(leaf.counts(), Counts { usable: 6, missing: 0, negative: 0 });
}

#[test]
fn the_long_example_is_read() {
    let leaf = one(LONG);
    assert_eq!((leaf.quantity, leaf.layout), (Quantity::Brf, Layout::Long));
    assert_eq!(leaf.wavelengths_nm, [400.0, 401.0]);
    assert_eq!(leaf.values, [0.116, 0.121, 0.117, 0.122]);
    assert_eq!(leaf.directions.len(), 2);
    assert!(leaf.sd.is_none());
}

#[test]
fn unknown_keys_and_remarks_are_kept() {
    let leaf = one(format!("# leaf age: 3 weeks\n# measured in the morning\n#\n{WIDE}# last: line\n"));
    let lines: Vec<_> = leaf.metadata.iter().collect();
    let expected = [
        ("leaf age", "3 weeks"),
        ("", "measured in the morning"),
        ("species", "Prunus laurocerasus"),
        ("last", "line"),
    ];
    assert_eq!(lines, expected);
}

#[test]
fn the_sample_names_the_leaf() {
    let leaf = one(format!("# sample: L7\n{WIDE}"));
    assert_eq!((leaf.name.as_str(), leaf.sample.as_deref()), ("L7", Some("L7")));
    assert!(leaf.metadata.get("sample").is_none());
}

#[test]
fn long_columns_come_in_any_order_and_others_are_ignored() {
    let leaf = one("operator,brdf,phi_v_deg,BRF,theta_v_deg,sd,wavelength_nm,theta_s_deg\n\
                    Ann,0.04,180,none,60,0.001,400,30\nBen,0.05,180,none,60,,401,30\n");
    assert_eq!((leaf.quantity, leaf.brdf()), (Quantity::Brdf, vec![0.04, 0.05]));
    let sd = leaf.brdf_sd().unwrap();
    assert_eq!(sd[0], 0.001);
    assert!(sd[1].is_nan());
}

#[test]
fn several_leaves_share_a_long_file() {
    let leaves = read(
        "sample,wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf\n\
                       b,400,30,60,180,0.2\na,400,30,60,180,0.1\nb,401,30,60,180,0.3\na,400,30,50,180,0.4\n",
    )
    .unwrap();
    let names: Vec<_> = leaves.iter().map(|leaf| leaf.name.as_str()).collect();
    assert_eq!(names, ["b", "a"]);
    assert_eq!(leaves[0].values, [0.2, 0.3]);
    assert_eq!(leaves[1].values, [0.1, 0.4]);
}

#[test]
fn long_rows_in_any_order_give_the_same_measurement() {
    let mut lines: Vec<&str> = LONG.lines().collect();
    lines[1..].reverse();
    let reversed = one(lines.join("\n"));
    assert_eq!(reversed.wavelengths_nm, [400.0, 401.0]);
    assert_eq!(reversed.values, [0.121, 0.116, 0.122, 0.117], "directions in order of their first rows");
}

#[test]
fn descending_wavelengths_are_held_ascending() {
    let leaf =
        one(wide("400,0.116,0.121,0.045\n401,0.117,0.122,0.044", "401,0.117,0.122,0.044\n400,0.116,0.121,0.045"));
    assert_eq!(leaf, one(WIDE));
}

#[test]
fn missing_values_are_left_out_and_counted() {
    let leaf = one(wide("0.116,0.121,0.045", ",NaN,NA"));
    assert!(leaf.values[..3].iter().all(|value| value.is_nan()));
    assert_eq!(leaf.counts(), Counts { usable: 3, missing: 3, negative: 0 });
    assert!(leaf.brdf()[0].is_nan());
    // A pair of wavelength and direction without a row is missing as well.
    let leaf = one(long("401,30,50,180,0.122\n", ""));
    assert_eq!(leaf.counts(), Counts { usable: 3, missing: 1, negative: 0 });
}

#[test]
fn negative_values_are_kept_and_counted() {
    let leaf = one(wide("0.045", "-0.002"));
    assert_eq!(leaf.values[2], -0.002);
    assert_eq!(leaf.counts(), Counts { usable: 6, missing: 0, negative: 1 });
}

#[test]
fn forward_0_is_turned_by_half_a_circle() {
    let turned = one(wide("# quantity: brf", "# quantity: brf\n# azimuth: forward_0"));
    let phi: Vec<f64> = turned.directions.iter().map(|d| d.phi_v_deg).collect();
    assert_eq!((turned.azimuth, phi), (Azimuth::Forward0, vec![0.0, 0.0, 180.0]));
    let options = ReadOptions { azimuth: Some(Azimuth::Forward0), ..ReadOptions::default() };
    assert_eq!(read_with(WIDE, options).unwrap()[0], turned);
    assert_eq!(one(WIDE).azimuth, Azimuth::Forward180, "the default");
}

#[test]
fn every_line_end_and_the_byte_order_mark_give_the_same_measurement() {
    let plain = one(WIDE);
    assert_eq!(one(WIDE.replace('\n', "\r\n")), plain, "Windows");
    assert_eq!(one(WIDE.replace('\n', "\r")), plain, "old Macintosh");
    assert_eq!(one(format!("\u{feff}{WIDE}")), plain, "byte order mark");
    assert_eq!(one(WIDE.trim_end()), plain, "no line end at the end");
    let remark = one(format!("{WIDE}# the end"));
    assert_eq!(Measurement { metadata: plain.metadata.clone(), ..remark }, plain, "a remark in an unended last line");
    assert_eq!(one(format!("{LONG}#")), one(LONG), "an empty one");
    assert_eq!(one(WIDE.replace("\n4", "\n\n4") + "\n\n"), plain, "blank lines");
}

#[test]
fn gzip_is_known_by_its_bytes() {
    assert_eq!(one(gzip(WIDE.as_bytes())), one(WIDE));
    let (first, second) = WIDE.split_at(100);
    assert_eq!(one([gzip(first.as_bytes()), gzip(second.as_bytes())].concat()), one(WIDE), "members in a row");
}

#[test]
fn quoted_cells_and_blanks_around_cells_are_read() {
    let quoted = LONG.replace("wavelength_nm,", "\"wavelength_nm\",").replace("400,30", "\"400\", 30 ");
    assert_eq!(one(quoted), one(LONG));
}

#[test]
fn mirror_images_are_two_directions() {
    assert_eq!(one(wide("180,180,0", "30,-30,0").replace("60,50,0", "60,60,0")).directions.len(), 3);
}

// What is refused.

#[test]
fn a_factor_of_pi_is_not_guessed() {
    let parts = ["does not say", "# quantity: brf", "# quantity: brdf", "--quantity"];
    refused(wide("# quantity: brf\n", ""), &parts);
    let options = ReadOptions { quantity: Some(Quantity::Brdf), ..ReadOptions::default() };
    assert_eq!(read_with(wide("# quantity: brf\n", ""), options).unwrap()[0].brdf()[0], 0.116);
    refused(wide("quantity: brf", "quantity: reflectance"), &["line 2", "\"reflectance\"", "expected brf", "or brdf"]);
    refused(wide("quantity: brf", "quantity:"), &["line 2", "expected brf"]);
    refused(long(",brf", ",reflectance"), &["line 1", "expected brf", "or brdf"]);
}

#[test]
fn an_option_that_contradicts_the_file_is_an_error() {
    let options = ReadOptions { quantity: Some(Quantity::Brdf), ..ReadOptions::default() };
    refused_with(WIDE, options, &["line 2", "the file says quantity brf and --quantity says brdf"]);
    refused_with(LONG, options, &["line 1, column 5", "the column is brf"]);
    refused(format!("# quantity: brdf\n{LONG}"), &["line 2, column 5", "the column is brf"]);
    refused(format!("# quantity: brdf\n{WIDE}"), &["line 3", "\"brf\"", "\"brdf\" in line 1"]);
    let options = ReadOptions { azimuth: Some(Azimuth::Forward180), ..ReadOptions::default() };
    refused_with(format!("# azimuth: forward_0\n{WIDE}"), options, &["line 1", "--azimuth says forward_180"]);
    refused(format!("# azimuth: north\n{WIDE}"), &["line 1", "\"north\"", "forward_180", "forward_0"]);
}

#[test]
fn both_quantities_in_a_long_file_need_a_choice() {
    let both = "wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf,brdf\n400,30,60,180,0.3,0.1\n";
    refused(both, &["line 1, column 6", "both a column brf and a column brdf", "--quantity"]);
    let options = ReadOptions { quantity: Some(Quantity::Brdf), ..ReadOptions::default() };
    assert_eq!(read_with(both, options).unwrap()[0].values, [0.1]);
}

#[test]
fn a_value_that_is_no_number_is_an_error() {
    refused(wide("0.045", "abc"), &["line 6, column 4", "found \"abc\"", "expected a number"]);
    refused(wide("0.045", "n/a"), &["line 6, column 4", "found \"n/a\"", "Leave the cell empty, or write NaN or NA"]);
    refused(wide("0.045", "inf"), &["line 6, column 4", "found \"inf\"", "infinite"]);
    refused(wide("0.045", "1e999"), &["line 6, column 4", "found \"1e999\"", "too large"]);
    refused(wide("0.045", "1e7"), &["line 6, column 4", "no reflectance is above 1e6"]);
    refused(wide("0.045", "-9999"), &["line 6, column 4", "a mark for a missing value?"]);
    refused(wide("0.045", "4.5%"), &["line 6, column 4", "per cent"]);
    refused(wide("0.045", "\u{1b}[31mred"), &["line 6, column 4", "found \"\\u{1b}[31mred\""]);
    refused(long("0.121", "abc"), &["line 3, column 5 (brf)", "found \"abc\"", "expected a number"]);
}

#[test]
fn the_line_is_counted_over_remarks_and_blank_lines() {
    refused(wide("401,0.117", "\n# a remark\n\n401,x"), &["line 10, column 2", "found \"x\""]);
    refused(wide("401,", "\r\n\r\n401,").replace("0.044", "x"), &["line 9, column 4", "found \"x\""]);
}

#[test]
fn a_decimal_comma_is_an_error() {
    refused(wide("0.045", "\"0,045\""), &["line 6, column 4", "decimal comma"]);
    refused(wide("0.116,0.121,0.045", "0,116,0,121,0,045"), &["line 6", "7 cells: expected 4", "decimal commas?"]);
    let german = WIDE.replace(',', ";").replace('.', ",");
    refused(german, &["line 3, column 1", "semicolons", "commas between the cells and decimal points"]);
    refused(WIDE.replace(',', "\t"), &["line 3, column 1", "tabs"]);
    refused(LONG.replace(',', ";"), &["line 1, column 1", "semicolons"]);
}

#[test]
fn a_ragged_row_is_an_error() {
    refused(wide(",0.045", ""), &["line 6, column 3", "3 cells: expected 4"]);
    refused(wide("0.045", "0.045,1"), &["line 6, column 5", "5 cells: expected 4"]);
    refused(wide("60,50,0", "60,50"), &["line 4", "3 cells: expected 4"]);
    refused(long(",0.121", ""), &["line 3, column 4", "4 cells: expected 5"]);
}

#[test]
fn a_duplicate_wavelength_is_an_error() {
    refused(wide("401", "400"), &["line 7, column 1", "400 nm", "line 6", "each wavelength once"]);
    refused(wide("401", "400.0"), &["line 7, column 1", "400 nm"]);
}

#[test]
fn a_duplicate_direction_is_an_error() {
    refused(wide("60,50,0", "60,60,0"), &["line 5, column 3", "θ_v 60°", "column 2", "each direction once"]);
    let same = wide("60,50,0", "60,60,0").replace("180,180,0", "330,-30,0");
    refused(same, &["line 5, column 3", "each direction once"]);
    let same = wide("60,50,0", "60,60,0").replace("180,180,0", "0,360,0");
    refused(same, &["line 5, column 3", "each direction once"]);
}

#[test]
fn a_duplicate_row_of_a_long_file_is_an_error() {
    refused(long("30,50", "30,60"), &["line 3", "400 nm", "θ_v 60°", "line 2", "sample"]);
}

#[test]
fn an_angle_out_of_range_is_an_error() {
    refused(wide("theta_s_deg,30", "theta_s_deg,90"), &["line 3, column 2", "found \"90\"", "0 ≤ θ < 90"]);
    refused(wide("60,50,0", "-60,50,0"), &["line 4, column 2", "found \"-60\"", "0 ≤ θ < 90", "turned by 180"]);
    refused(wide("180,180,0", "180,361,0"), &["line 5, column 3", "found \"361\"", "−360 ≤ φ ≤ 360"]);
    refused(wide("180,180,0", "180,,0"), &["line 5, column 3", "an empty cell", "azimuth"]);
    refused(wide("180,180,0", "180,180,nan"), &["line 5, column 4", "found \"nan\"", "azimuth"]);
    refused(long("30,50", "30,95"), &["line 3, column 3 (theta_v_deg)", "found \"95\"", "0 ≤ θ < 90"]);
}

#[test]
fn a_wavelength_must_be_in_nanometres() {
    refused(wide("401", "0.401"), &["line 7, column 1", "found \"0.401\"", "did you mean nm?"]);
    refused(wide("401", "-401"), &["line 7, column 1", "wavelength in nm"]);
    refused(wide("401", ""), &["line 7, column 1", "an empty cell", "wavelength in nm"]);
    refused(wide("401", "blue"), &["line 7, column 1", "found \"blue\"", "wavelength in nm"]);
    refused(wide("401", "1e6"), &["line 7, column 1", "100 to 100000"]);
    refused(long("401", "0.401"), &["line 4, column 1 (wavelength_nm)", "did you mean nm?"]);
}

#[test]
fn no_usable_value_is_an_error() {
    let empty = WIDE.replace("0.116,0.121,0.045", ",,").replace("0.117,0.122,0.044", "NA,NaN,");
    refused(empty, &["every value is missing", "at least one number"]);
    refused(WIDE.split_once("400").unwrap().0, &["no row of values", "at least one number"]);
    refused(LONG.split_once("400").unwrap().0, &["no row of values", "at least one number"]);
    refused(
        LONG.replace("0.1", "NaN").replace("NaN16", "").replace("NaN21", "").replace("NaN17", "").replace("NaN22", ""),
        &["every value is missing"],
    );
    let samples =
        "sample,wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf\na,400,30,60,180,0.2\nb,400,30,60,180,NA\n";
    refused(samples, &["of sample \"b\"", "missing"]);
}

#[test]
fn a_missing_row_or_column_is_named() {
    refused(wide("theta_v_deg,60,50,0\n", ""), &["line 5, column 1", "expected the row theta_v_deg"]);
    refused(
        wide("theta_v_deg,60,50,0", "theta_s_deg,60,50,0"),
        &["line 4", "\"theta_s_deg\" stands in line 3 already"],
    );
    refused("# quantity: brf\ntheta_s_deg,30\n", &["ends before its three rows of angles"]);
    refused("# quantity: brf\ntheta_s_deg\n", &["line 2", "no angle"]);
    refused(
        long("theta_v_deg", "theta_v"),
        &["line 1", "no column theta_v_deg", "matched exactly", "is it \"theta_v\"?"],
    );
    refused(long("wavelength_nm", "Wavelength_nm"), &["no column wavelength_nm", "is it \"Wavelength_nm\"?"]);
    refused(LONG.replace("brf", "brf,brf"), &["line 1, column 6", "a second column brf"]);
    refused(wide("theta_s_deg", "Theta_s_deg"), &["line 3, column 1", "matched exactly"]);
}

#[test]
fn sd_and_sample_are_checked() {
    let with = |name: &str, cell: &str| {
        format!("wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf,{name}\n400,30,60,180,0.1,{cell}\n")
    };
    refused(with("sd", "-0.1"), &["line 2, column 6 (sd)", "standard deviation ≥ 0"]);
    refused(with("sd", "?"), &["line 2, column 6 (sd)", "found \"?\""]);
    refused(with("sample", ""), &["line 2, column 6 (sample)", "an empty cell", "name of a sample"]);
}

#[test]
fn what_is_no_text_is_an_error() {
    refused("", &["empty"]);
    refused("\n\n", &["no data"]);
    refused("# quantity: brf\n", &["no data, only remarks"]);
    refused(WIDE.replace("0.121", "0.1\u{0}1"), &["line 6", "binary data"]);
    refused(b"\x89HDF\r\n\x1a\n\0\0\0", &["HDF5"]);
    refused(b"PK\x03\x04rest", &["Excel", "export the sheet as CSV"]);
    let utf16: Vec<u8> = format!("\u{feff}{WIDE}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    refused(utf16, &["UTF-16", "UTF-8"]);
    let utf16: Vec<u8> = WIDE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    refused(utf16, &["line 1", "binary data"]);
    let latin1 = [b"# species: Acer \xd7\n", WIDE.as_bytes()].concat();
    refused(latin1, &["line 1", "0xd7", "encoding UTF-8"]);
    refused("this is\nno measurement\n", &["line 1, column 1", "expected theta_s_deg", "wavelength_nm"]);
}

#[test]
fn a_truncated_or_damaged_gzip_file_is_an_error() {
    let whole = gzip(WIDE.repeat(50).as_bytes());
    for length in [3, 12, whole.len() / 2, whole.len() - 1] {
        refused(&whole[..length], &["gzip", "truncated or damaged"]);
    }
    let mut damaged = gzip(WIDE.as_bytes());
    let middle = damaged.len() / 2;
    damaged[middle] ^= 0xff;
    refused(&damaged, &["gzip", "truncated or damaged"]);
    refused([gzip(WIDE.as_bytes()), b"rest".to_vec()].concat(), &["gzip"]);
}

#[test]
fn a_quote_that_is_not_closed_is_an_error() {
    refused(wide("0.121", "\"0.121"), &["line 6, column 3", "close its quote"]);
    let ignored = LONG.replace(",brf", ",brf,note").replace("0.116", "0.116,\"half a note").replace("0.121", "0.121,");
    refused(ignored, &["line 2, column 6", "close its quote"]);
}

#[test]
fn a_sparse_grid_is_refused_before_it_fills_the_memory() {
    let rows = (0..5000).map(|i| format!("{},30,{},180,0.1\n", 400.0 + f64::from(i) / 10.0, f64::from(i) / 100.0));
    let file = "wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf\n".to_string() + &rows.collect::<String>();
    refused(file, &["5000 wavelengths and 5000 directions", "sample"]);
}

#[test]
fn a_file_that_cannot_be_opened_is_named() {
    let path = std::path::Path::new("no-such-folder/leaf.csv");
    let message = leafbrdf::measurement::read_path(path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(message.starts_with("no-such-folder/leaf.csv: cannot be read: "), "{message}");
}

// The warning.

#[test]
fn a_peak_on_the_wrong_side_deserves_a_warning() {
    let file = "# quantity: brf\ntheta_s_deg,40,40,40\ntheta_v_deg,40,40,0\nphi_v_deg,180,0,0\n500,0.6,0.1,0.1\n";
    assert_eq!(one(file).azimuth_warning(), None);
    let options = ReadOptions { azimuth: Some(Azimuth::Forward0), ..ReadOptions::default() };
    let warning = read_with(file, options).unwrap()[0].azimuth_warning().unwrap();
    assert!(warning.contains("illumination side") && warning.contains("--azimuth forward_180"), "{warning}");
}

// The documentation.

#[test]
fn the_examples_of_the_documentation_are_read() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/formats.md");
    let text = std::fs::read_to_string(path).unwrap();
    let examples: Vec<&str> = text.split("```csv\n").skip(1).map(|rest| rest.split("```").next().unwrap()).collect();
    let [wide, long, spectra, points] = examples.as_slice() else { panic!("four examples expected") };
    assert_eq!(one(wide).counts().usable, 6);
    let leaves = read(long).unwrap();
    assert_eq!(leaves.iter().map(|leaf| leaf.name.as_str()).collect::<Vec<_>>(), ["upper", "lower"]);
    assert!(leaves[1].sd.is_some());
    let spectra = leafbrdf::spectra::spectra_from_bytes("spectra.csv", spectra.as_bytes()).unwrap();
    assert_eq!(spectra.iter().map(|leaf| leaf.wavelengths_nm.len()).collect::<Vec<_>>(), [2, 1]);
    let points = leafbrdf::points::Points::from_bytes("points.csv", points.as_bytes()).unwrap();
    assert_eq!(points.number(1, points.require("sigma").unwrap()), Ok(0.29));
    // The message that the document shows.
    let decimal_comma = wide.replace("0.045", "\"0,045\"");
    let message = read(decimal_comma).unwrap_err();
    let shown = text.split_once("laurel.csv, line 212, column 4: ").unwrap().1.lines().next().unwrap();
    assert!(message.ends_with(shown), "{message}");
}
