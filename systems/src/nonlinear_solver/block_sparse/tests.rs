use super::super::test_support::{Random, dense, distance, dominant, graphs, random_dims};
use super::*;

#[test]
fn pattern_merges_duplicates_and_has_the_diagonal() {
    let pattern = BlockPattern::new(&[3, 6, 3], &[(0, 1), (1, 0), (0, 1), (2, 2)]);
    assert_eq!(pattern.sites(), 3);
    assert_eq!(pattern.dimension(), 12);
    assert_eq!(pattern.blocks(), 5);
    assert_eq!(pattern.values(), 9 + 18 + 18 + 36 + 9);
    assert_eq!(pattern.row(0), [0, 1]);
    assert_eq!(pattern.row(1), [0, 1]);
    assert_eq!(pattern.row(2), [2]);
    assert_eq!(pattern.offset(2), 9);
    assert_eq!(pattern.block_index(0, 2), None);
    assert_eq!(pattern.block_index(1, 0), Some(2));
}

#[test]
fn entries_are_added_in_place() {
    let mut matrix = BlockMatrix::new(BlockPattern::new(&[3, 6], &[(0, 1)]));
    matrix.add(0, 1, 2, 4, 1.5);
    matrix.add(0, 1, 2, 4, 1.0);
    assert_eq!(matrix.block(0, 1)[2 * 6 + 4], 2.5);
    assert!(matrix.block(1, 0).iter().all(|&v| v == 0.0));
    matrix.block_mut(1, 0)[0] = 7.0;
    let mut y = vec![f64::NAN; 9];
    matrix.multiply(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0], &mut y);
    assert_eq!(y, [0.0, 0.0, 5.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    matrix.clear();
    assert!(matrix.values().iter().all(|&v| v == 0.0));
}

#[test]
fn blocks_outside_the_pattern_are_empty() {
    let mut matrix = BlockMatrix::new(BlockPattern::new(&[3, 3], &[]));
    assert!(matrix.block(0, 1).is_empty());
    assert!(matrix.block_mut(1, 0).is_empty());
}

#[test]
fn product_equals_the_dense_one() {
    let mut random = Random::new(3);
    for (name, edges) in graphs(17, &mut random) {
        let dims = random_dims(17, &mut random);
        let matrix = dominant(&BlockPattern::new(&dims, &edges), false, &mut random);
        let x: Vec<f64> = (0..matrix.pattern().dimension())
            .map(|_| random.signed())
            .collect();
        let mut y = vec![0.0; x.len()];
        matrix.multiply(&x, &mut y);
        let expected: Vec<f64> = dense(&matrix)
            .iter()
            .map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum())
            .collect();
        assert!(distance(&y, &expected) < 1e-12, "{name}");
    }
}
