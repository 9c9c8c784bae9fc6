//! Sobol's sequence with the direction numbers of Joe and Kuo (SIAM J. Sci. Comput. 30, 2635 (2008), file
//! new-joe-kuo-6.21201), shifted at random bit by bit: every run of 2^k points that starts at a multiple of
//! 2^k has one point in each of 2^k equal parts of every field, whatever the shift.

use super::random_stream::{Purpose, RandomStream};

/// Bits of a coordinate.
const BITS: u32 = 32;

/// Degree and inner coefficients of the primitive polynomial, and the first direction numbers, of the second
/// coordinate and those after it.
const DIRECTIONS: [(u32, u32, &[u32]); 39] = [
    (1, 0, &[1]),
    (2, 1, &[1, 3]),
    (3, 1, &[1, 3, 1]),
    (3, 2, &[1, 1, 1]),
    (4, 1, &[1, 1, 3, 3]),
    (4, 4, &[1, 3, 5, 13]),
    (5, 2, &[1, 1, 5, 5, 17]),
    (5, 4, &[1, 1, 5, 5, 5]),
    (5, 7, &[1, 1, 7, 11, 19]),
    (5, 11, &[1, 1, 5, 1, 1]),
    (5, 13, &[1, 1, 1, 3, 11]),
    (5, 14, &[1, 3, 5, 5, 31]),
    (6, 1, &[1, 3, 3, 9, 7, 49]),
    (6, 13, &[1, 1, 1, 15, 21, 21]),
    (6, 16, &[1, 3, 1, 13, 27, 49]),
    (6, 19, &[1, 1, 1, 15, 7, 5]),
    (6, 22, &[1, 3, 1, 15, 13, 25]),
    (6, 25, &[1, 1, 5, 5, 19, 61]),
    (7, 1, &[1, 3, 7, 11, 23, 15, 103]),
    (7, 4, &[1, 3, 7, 13, 13, 15, 69]),
    (7, 7, &[1, 1, 3, 13, 7, 35, 63]),
    (7, 8, &[1, 3, 5, 9, 1, 25, 53]),
    (7, 14, &[1, 3, 1, 13, 9, 35, 107]),
    (7, 19, &[1, 3, 1, 5, 27, 61, 31]),
    (7, 21, &[1, 1, 5, 11, 19, 41, 61]),
    (7, 28, &[1, 3, 5, 3, 3, 13, 69]),
    (7, 31, &[1, 1, 7, 13, 1, 19, 1]),
    (7, 32, &[1, 3, 7, 5, 13, 19, 59]),
    (7, 37, &[1, 1, 3, 9, 25, 29, 41]),
    (7, 41, &[1, 3, 5, 13, 23, 1, 55]),
    (7, 42, &[1, 3, 7, 3, 13, 59, 17]),
    (7, 50, &[1, 3, 1, 3, 5, 53, 69]),
    (7, 55, &[1, 1, 5, 5, 23, 33, 13]),
    (7, 56, &[1, 1, 7, 7, 1, 61, 123]),
    (7, 59, &[1, 1, 7, 9, 13, 61, 49]),
    (7, 62, &[1, 3, 3, 5, 3, 55, 33]),
    (8, 14, &[1, 3, 1, 15, 31, 13, 49, 245]),
    (8, 21, &[1, 3, 5, 15, 31, 59, 63, 97]),
    (8, 22, &[1, 3, 1, 11, 11, 11, 77, 249]),
];

/// The most fields that the sequence has coordinates for.
pub const MOST_FIELDS: usize = DIRECTIONS.len() + 1;
/// The most points that it has.
pub const MOST_POINTS: u64 = 1 << BITS;

/// A shifted sequence.
pub struct Sobol {
    /// Per field: what each bit of the point's number turns over, and the shift.
    fields: Vec<([u32; BITS as usize], u32)>,
}

impl Sobol {
    /// The sequence of a seed for so many fields, at most [`MOST_FIELDS`].
    #[must_use]
    pub fn new(seed: u64, fields: usize) -> Self {
        let shift = |field| RandomStream::new(seed, Purpose::Shift, field as u64).bits() >> 32;
        let fields =
            (0..fields.min(MOST_FIELDS)).map(|field| (directions(field), shift(field) as u32));
        Self {
            fields: fields.collect(),
        }
    }

    /// The number of fields.
    #[must_use]
    pub fn fields(&self) -> usize {
        self.fields.len()
    }

    /// A coordinate of a point, above 0 and below 1.
    #[must_use]
    pub fn coordinate(&self, point: u64, field: usize) -> f64 {
        let Some((directions, shift)) = self.fields.get(field) else {
            return 0.5;
        };
        let bits = (0..BITS as usize).filter(|bit| point >> bit & 1 == 1);
        let sum = bits.fold(*shift, |sum, bit| sum ^ directions[bit]);
        (f64::from(sum) + 0.5) / MOST_POINTS as f64
    }
}

/// By the recurrence of the polynomial; the first coordinate is van der Corput's.
fn directions(field: usize) -> [u32; BITS as usize] {
    let mut found = [0; BITS as usize];
    let Some((degree, inner, first)) = field.checked_sub(1).and_then(|k| DIRECTIONS.get(k)) else {
        for (bit, direction) in found.iter_mut().enumerate() {
            *direction = 1 << (BITS as usize - 1 - bit);
        }
        return found;
    };
    let degree = *degree as usize;
    for bit in 0..BITS as usize {
        found[bit] = match first.get(bit) {
            Some(number) => number << (BITS as usize - 1 - bit),
            None => {
                let start = found[bit - degree] ^ (found[bit - degree] >> degree);
                let taps = (1..degree).filter(|k| inner >> (degree - 1 - k) & 1 == 1);
                taps.fold(start, |sum, k| sum ^ found[bit - k])
            }
        };
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One point in each of 2^k parts of every field, for aligned runs of points.
    #[test]
    fn powers_of_two_fill_every_part_once() {
        let sobol = Sobol::new(5, MOST_FIELDS);
        for field in 0..MOST_FIELDS {
            for (start, count) in [(0, 64), (64, 64), (0, 256), (1024, 1024)] {
                let mut parts: Vec<usize> = (start..start + count)
                    .map(|point| (sobol.coordinate(point, field) * count as f64) as usize)
                    .collect();
                parts.sort_unstable();
                assert!(
                    parts.iter().enumerate().all(|(k, part)| k == *part),
                    "{field}"
                );
            }
        }
    }

    /// The first two fields are a (0, 2)-sequence: 2^k points fill every rectangle of area 2^-k once.
    #[test]
    fn the_first_two_fields_fill_rectangles() {
        let sobol = Sobol::new(9, 2);
        for wide in 0..=8_u32 {
            let (columns, rows) = (1 << wide, 1 << (8 - wide));
            let mut cells: Vec<usize> = (0..256)
                .map(|point| {
                    let column = (sobol.coordinate(point, 0) * f64::from(columns)) as usize;
                    let row = (sobol.coordinate(point, 1) * f64::from(rows)) as usize;
                    column * rows as usize + row
                })
                .collect();
            cells.sort_unstable();
            assert!(
                cells.iter().enumerate().all(|(k, cell)| k == *cell),
                "{wide}"
            );
        }
    }

    /// x has the order 2^degree - 1 modulo each polynomial, and direction numbers are odd and small.
    #[test]
    fn the_table_is_of_primitive_polynomials() {
        for (degree, inner, first) in DIRECTIONS {
            let polynomial = 1 << degree | inner << 1 | 1;
            let mut power: u32 = 1;
            let order = (1_u32..).find(|_| {
                power <<= 1;
                if power >> degree & 1 == 1 {
                    power ^= polynomial;
                }
                power == 1
            });
            assert_eq!(order, Some((1 << degree) - 1), "{degree} {inner}");
            assert_eq!(first.len(), degree as usize);
            let fits = |(k, m): (usize, &u32)| m % 2 == 1 && *m < 2 << k;
            assert!(first.iter().enumerate().all(fits), "{degree} {inner}");
        }
    }
}
