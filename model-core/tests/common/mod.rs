//! Reading the golden files: `#` lines are their papers, then a header, then numbers.

/// The rows of a golden file as numbers, and a function from column name to its place.
pub struct Table {
    header: Vec<String>,
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    pub fn read(text: &str) -> Table {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let header = lines.next().unwrap().split(',').map(String::from).collect();
        let rows = lines.map(|line| line.split(',').map(|cell| cell.trim().parse().unwrap()).collect()).collect();
        Table { header, rows }
    }

    pub fn column(&self, name: &str) -> usize {
        self.header.iter().position(|column| column == name).unwrap()
    }
}
