//! Filled level sets of a function on a grid: where it is at least so large.

use super::svg::number;

/// A function at the nodes of a grid, row by row.
#[derive(Clone, Debug)]
pub struct Grid {
    columns: usize,
    rows: usize,
    values: Vec<f64>,
}

impl Grid {
    /// `value(column, row)` at each node.
    pub fn new(columns: usize, rows: usize, mut value: impl FnMut(usize, usize) -> f64) -> Self {
        let values = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        Grid { columns, rows, values: values.map(|(column, row)| value(column, row)).collect() }
    }

    /// The value at a node; −∞ around the grid and where there is no number, so that every level set is closed.
    fn at(&self, column: isize, row: isize) -> f64 {
        let inside = |place: isize, count: usize| usize::try_from(place).ok().filter(|place| *place < count);
        let value = inside(column, self.columns)
            .zip(inside(row, self.rows))
            .and_then(|(column, row)| self.values.get(row * self.columns + column));
        value.copied().filter(|value| !value.is_nan()).unwrap_or(f64::NEG_INFINITY)
    }

    /// The set where the function is at least `level`, as closed lines (marching squares, linear between nodes); `place` puts
    /// a pair of grid coordinates on the figure, px.
    ///
    /// Fill it by the even-odd rule. Where a cell is a saddle, the mean of its corners decides.
    pub fn at_least(&self, level: f64, place: impl Fn(f64, f64) -> [f64; 2]) -> Vec<Vec<[f64; 2]>> {
        // Nodes run from −1 to count: one ring of −∞ around. An edge is named by its lower node, to the right (0) or down (1).
        let wide = self.columns + 2;
        let edge =
            |column: isize, row: isize, down: usize| 2 * ((row + 1) as usize * wide + (column + 1) as usize) + down;
        const NONE: usize = usize::MAX;
        let mut next = vec![NONE; 2 * wide * (self.rows + 2)];
        let mut starts = Vec::new();
        for row in -1..self.rows as isize {
            for column in -1..self.columns as isize {
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(dx, dy)| self.at(column + dx, row + dy));
                // edges of the cell: upper, right, lower, left; corner i lies between edge i − 1 and edge i
                let edges =
                    [edge(column, row, 0), edge(column + 1, row, 1), edge(column, row + 1, 0), edge(column, row, 1)];
                let high = corners.map(|value| value >= level);
                let count = high.iter().filter(|high| **high).count();
                if count == 0 || count == 4 {
                    continue;
                }
                let saddle = count == 2 && high[0] == high[2];
                let joined = saddle && corners.iter().sum::<f64>() / 4.0 >= level;
                for i in 0..4 {
                    // a line enters by the edge after which the corners are high, and leaves by the one after which they are low
                    let (before, here) = (high[(i + 3) % 4], high[i]);
                    if here == before || !here {
                        continue;
                    }
                    let entry = edges[(i + 3) % 4];
                    let leaves = |step: usize| !high[(i + step + 1) % 4];
                    let run = if joined { 2 } else { (0..4).find(|step| leaves(*step)).unwrap_or(0) };
                    let exit = edges[(i + run) % 4];
                    next[exit] = entry;
                    starts.push(exit);
                }
            }
        }
        let point = |edge: usize| {
            let (node, down) = (edge / 2, edge % 2);
            let (row, column) = ((node / wide) as isize - 1, (node % wide) as isize - 1);
            let (a, b) = (self.at(column, row), self.at(column + 1 - down as isize, row + down as isize));
            // beside −∞ the line runs through the node that has a value
            let part = match (a.is_finite(), b.is_finite()) {
                (true, true) => ((level - a) / (b - a)).clamp(0.0, 1.0),
                (false, _) => 1.0,
                (_, false) => 0.0,
            };
            let (dx, dy) = if down == 1 { (0.0, part) } else { (part, 0.0) };
            place(column as f64 + dx, row as f64 + dy)
        };
        let mut loops = Vec::new();
        for start in starts {
            let mut line = Vec::new();
            let mut edge = start;
            while next[edge] != NONE {
                line.push(point(edge));
                edge = std::mem::replace(&mut next[edge], NONE);
            }
            if line.len() > 2 {
                loops.push(line);
            }
        }
        loops
    }
}

/// Closed lines as one path; points nearer than 0.6 px to the last are left out.
pub fn path(loops: &[Vec<[f64; 2]>]) -> String {
    let mut data = String::new();
    // relative steps in tenths of a pixel: half the letters of absolute ones
    let tenths = |x: f64| (x * 10.0).round() / 10.0;
    for line in loops {
        let Some(&[x, y]) = line.first() else { continue };
        let [mut x, mut y] = [tenths(x), tenths(y)];
        let mut one = format!("M{} {}l", number(x), number(y));
        let mut steps = 0;
        for &[to_x, to_y] in line.iter().skip(1) {
            let [dx, dy] = [tenths(to_x - x), tenths(to_y - y)];
            if dx.hypot(dy) < 0.6 {
                continue;
            }
            let separator = if steps == 0 || dx < 0.0 { "" } else { " " };
            one.push_str(separator);
            one.push_str(&number(dx));
            one.push_str(if dy < 0.0 { "" } else { " " });
            one.push_str(&number(dy));
            (x, y) = (x + dx, y + dy);
            steps += 1;
        }
        if steps > 1 {
            data.push_str(&one);
            data.push('z');
        }
    }
    data
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Signed area by the shoelace formula.
    fn area(line: &[[f64; 2]]) -> f64 {
        let ends = line.iter().zip(line.iter().cycle().skip(1));
        0.5 * ends.map(|([x0, y0], [x1, y1])| x0 * y1 - x1 * y0).sum::<f64>()
    }

    fn total(loops: &[Vec<[f64; 2]>]) -> f64 {
        loops.iter().map(|line| area(line)).sum::<f64>().abs()
    }

    #[test]
    fn the_level_set_of_a_cone_is_a_disc() {
        let grid = Grid::new(81, 81, |i, j| 40.0 - ((i as f64 - 40.0).powi(2) + (j as f64 - 40.0).powi(2)).sqrt());
        for radius in [5.0_f64, 17.3, 30.0] {
            let loops = grid.at_least(40.0 - radius, |x, y| [x, y]);
            assert_eq!(loops.len(), 1);
            // chords of a unit grid: the area is short by about 1/(8 r²) of itself at most, 0.6 % at r = 5
            let expected = std::f64::consts::PI * radius * radius;
            assert!((total(&loops) / expected - 1.0).abs() < 0.01, "{radius}");
        }
    }

    #[test]
    fn a_ring_has_a_hole_of_the_other_sense() {
        let grid = Grid::new(61, 61, |i, j| -(((i as f64 - 30.0).hypot(j as f64 - 30.0)) - 15.0).abs());
        let loops = grid.at_least(-5.0, |x, y| [x, y]);
        assert_eq!(loops.len(), 2);
        let expected = std::f64::consts::PI * (400.0 - 100.0);
        assert!((total(&loops) / expected - 1.0).abs() < 0.01, "{}", total(&loops));
        assert!(area(&loops[0]) * area(&loops[1]) < 0.0);
    }

    #[test]
    fn what_is_high_everywhere_is_the_whole_grid_and_holes_are_left_out() {
        let whole = Grid::new(5, 4, |_, _| 1.0).at_least(0.5, |x, y| [x, y]);
        assert_eq!((whole.len(), total(&whole)), (1, 12.0));
        let holed = Grid::new(5, 5, |i, j| if (i, j) == (2, 2) { f64::NAN } else { 1.0 }).at_least(0.5, |x, y| [x, y]);
        assert_eq!(holed.len(), 2);
        assert!(Grid::new(5, 4, |_, _| 0.0).at_least(0.5, |x, y| [x, y]).is_empty());
    }

    #[test]
    fn a_saddle_is_cut_or_joined_as_its_mean_says() {
        let corners = |centre: f64| Grid::new(2, 2, move |i, j| if i == j { 1.0 } else { centre });
        assert_eq!(corners(-2.0).at_least(0.0, |x, y| [x, y]).len(), 2);
        assert_eq!(corners(-0.5).at_least(0.0, |x, y| [x, y]).len(), 1);
    }
}
