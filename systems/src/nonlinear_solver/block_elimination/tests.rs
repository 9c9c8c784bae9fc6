use super::super::test_support::{
    Random, chain, dense, dense_solve, distance, dominant, graphs, random_dims, suspension,
};
use super::*;

fn random_vector(length: usize, random: &mut Random) -> Vec<f64> {
    (0..length).map(|_| random.signed()).collect()
}

#[test]
fn solution_equals_dense_elimination() {
    let mut random = Random::new(1);
    for sites in 1..=40 {
        for (name, edges) in graphs(sites, &mut random) {
            let dims = random_dims(sites, &mut random);
            let pattern = BlockPattern::new(&dims, &edges);
            let mut elimination = Elimination::analyse(&pattern);
            // Twice with one analysis: nothing may be left of the first.
            for exchange in [true, false] {
                // Exchanged rows dominate inside the blocks only after pivoting.
                let matrix = dominant(&pattern, exchange, &mut random);
                let b = random_vector(pattern.dimension(), &mut random);
                let mut x = b.clone();
                elimination.factorise(&matrix).unwrap();
                elimination.solve(&mut x);
                let expected = dense_solve(dense(&matrix), &b);
                assert!(distance(&x, &expected) < 1e-11, "{name} of {sites}");
            }
        }
    }
}

#[test]
fn sites_of_any_dimension_are_solved() {
    let mut random = Random::new(9);
    let pattern = BlockPattern::new(
        &[1, 2, 0, 5, 8, 3],
        &[(0, 1), (1, 3), (3, 4), (4, 5), (5, 0)],
    );
    let matrix = dominant(&pattern, false, &mut random);
    let b = random_vector(pattern.dimension(), &mut random);
    let mut elimination = Elimination::analyse(&pattern);
    elimination.factorise(&matrix).unwrap();
    let mut x = b.clone();
    elimination.solve(&mut x);
    assert!(distance(&x, &dense_solve(dense(&matrix), &b)) < 1e-12);
    let nothing = BlockPattern::new(&[], &[]);
    let mut elimination = Elimination::analyse(&nothing);
    elimination.factorise(&BlockMatrix::new(nothing)).unwrap();
    elimination.solve(&mut []);
}

#[test]
fn storage_is_linear_on_chains_and_suspensions() {
    let sites = 10_000;
    let pattern = BlockPattern::new(&vec![3; sites], &chain(sites));
    assert!(Elimination::analyse(&pattern).stored_blocks() <= 3 * sites);

    let (dims, edges) = suspension(3333);
    let pattern = BlockPattern::new(&dims, &edges);
    let elimination = Elimination::analyse(&pattern);
    assert!(elimination.stored_blocks() <= 5 * dims.len() + 10);
    // The bodies go last.
    let order: Vec<usize> = elimination.order().collect();
    let mut last = order[order.len() - 2..].to_vec();
    last.sort_unstable();
    assert_eq!(last, [3 * 3333, 3 * 3333 + 1]);
}

#[test]
fn long_suspension_is_solved() {
    let mut random = Random::new(5);
    let (dims, edges) = suspension(3333);
    let pattern = BlockPattern::new(&dims, &edges);
    let matrix = dominant(&pattern, false, &mut random);
    let expected = random_vector(pattern.dimension(), &mut random);
    let mut x = vec![0.0; expected.len()];
    matrix.multiply(&expected, &mut x);
    let mut elimination = Elimination::analyse(&pattern);
    elimination.factorise(&matrix).unwrap();
    elimination.solve(&mut x);
    assert!(distance(&x, &expected) < 1e-12);
}

#[test]
fn trees_have_no_fill() {
    let mut random = Random::new(7);
    for sites in [1, 2, 10, 500] {
        let edges: Vec<_> = (1..sites).map(|i| (random.below(i), i)).collect();
        let pattern = BlockPattern::new(&vec![3; sites], &edges);
        let elimination = Elimination::analyse(&pattern);
        assert_eq!(elimination.stored_blocks(), pattern.blocks());
    }
}

#[test]
fn singular_matrices_name_the_site() {
    let pattern = BlockPattern::new(&[3, 6, 3], &[(0, 1), (1, 2)]);
    let mut elimination = Elimination::analyse(&pattern);
    let mut random = Random::new(2);
    let mut matrix = dominant(&pattern, false, &mut random);
    matrix.block_mut(0, 0).fill(0.0);
    assert_eq!(elimination.factorise(&matrix), Err(Singular { site: 0 }));
    matrix.block_mut(0, 0).fill(f64::NAN);
    assert_eq!(elimination.factorise(&matrix), Err(Singular { site: 0 }));

    // A free pair of masses: singular only by cancellation at the second.
    let pattern = BlockPattern::new(&[3, 3], &[(0, 1)]);
    let mut matrix = BlockMatrix::new(pattern.clone());
    for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
        for r in 0..3 {
            for c in 0..3 {
                let stiffness = [[2.0, 0.3, 0.1], [0.3, 3.0, 0.7], [0.1, 0.7, 1.1]][r][c];
                matrix.add(i, j, r, c, if i == j { stiffness } else { -stiffness });
            }
        }
    }
    let mut elimination = Elimination::analyse(&pattern);
    assert_eq!(elimination.factorise(&matrix), Err(Singular { site: 1 }));
    matrix.add(1, 1, 0, 0, 1.0);
    matrix.add(1, 1, 1, 1, 1.0);
    matrix.add(1, 1, 2, 2, 1.0);
    assert_eq!(elimination.factorise(&matrix), Ok(()));
}
