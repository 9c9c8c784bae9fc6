use super::super::test_support::{Random, graphs, suspension};
use super::*;

fn is_valid(pattern: &BlockPattern, colours: &[usize]) -> bool {
    (0..pattern.sites()).all(|i| {
        (0..i).all(|j| {
            let near = pattern.row(i).iter().any(|k| pattern.row(j).contains(k));
            !near || colours[i] != colours[j]
        })
    })
}

fn count(colours: &[usize]) -> usize {
    colours.iter().max().map_or(0, |most| most + 1)
}

#[test]
fn colours_are_valid_on_random_graphs() {
    let mut random = Random::new(11);
    for sites in 1..=40 {
        for (name, edges) in graphs(sites, &mut random) {
            let pattern = BlockPattern::new(&vec![3; sites], &edges);
            let colours = colour(&pattern);
            assert_eq!(colours.len(), sites);
            assert!(is_valid(&pattern, &colours), "{name} of {sites}");
            // No colour is left out.
            assert!(
                (0..count(&colours)).all(|c| colours.contains(&c)),
                "{name} of {sites}"
            );
            if name.ends_with("chain") {
                assert_eq!(count(&colours), sites.min(3), "{name} of {sites}");
            }
            if name == "ring" {
                assert!(count(&colours) <= 5);
            }
        }
    }
}

#[test]
fn suspensions_need_few_colours() {
    for length in 2..40 {
        let (dims, edges) = suspension(length);
        let pattern = BlockPattern::new(&dims, &edges);
        let colours = colour(&pattern);
        assert!(is_valid(&pattern, &colours));
        assert!(count(&colours) <= 5, "{length}: {}", count(&colours));
    }
    assert!(colour(&BlockPattern::new(&[], &[])).is_empty());
}
