//! Colouring of sites for finite-difference Jacobians.
//!
//! Columns of a Jacobian whose stored rows do not overlap can be perturbed
//! together (Curtis, Powell and Reid, "On the estimation of sparse Jacobian
//! matrices", J. Inst. Maths Applics 13 (1974) 117). For a symmetric block
//! pattern this holds for two sites that are not neighbours and have no common
//! neighbour, i.e. at a distance above 2 in the graph (Coleman and Moré, SIAM
//! J. Numer. Anal. 20 (1983) 187). The colouring is greedy, outwards along the
//! chains from the sites where they meet.

use std::collections::VecDeque;

use super::block_sparse::BlockPattern;

#[cfg(test)]
mod tests;

/// A colour `0, 1, …` for each site, such that two sites of one colour are
/// neither neighbours nor have a common neighbour.
///
/// Chains need 3 colours in whatever order their sites are numbered, and
/// chains that meet at a site with `m` neighbours about `max(m + 1, 5)`.
#[must_use]
pub fn colour(pattern: &BlockPattern) -> Vec<usize> {
    let sites = pattern.sites();
    let mut colours = vec![usize::MAX; sites];
    // Last site that found the colour taken.
    let mut taken_for = Vec::new();
    for site in outwards_from_junctions(pattern) {
        for &neighbour in pattern.row(site) {
            for &other in pattern.row(neighbour) {
                if let Some(mark) = taken_for.get_mut(colours[other]) {
                    *mark = site;
                }
            }
        }
        let found = taken_for.iter().position(|&mark| mark != site);
        let chosen = found.unwrap_or(taken_for.len());
        if found.is_none() {
            taken_for.push(usize::MAX);
        }
        colours[site] = chosen;
    }
    colours
}

/// All sites breadth-first: from all junctions (three or more neighbours) at
/// once, those with the most neighbours first, then chains and rings without
/// any.
fn outwards_from_junctions(pattern: &BlockPattern) -> Vec<usize> {
    let degree = |site: usize| pattern.row(site).len() - 1;
    let mut junctions: Vec<usize> = (0..pattern.sites()).filter(|&i| degree(i) > 2).collect();
    junctions.sort_by_key(|&site| std::cmp::Reverse(degree(site)));
    let mut reached = vec![false; pattern.sites()];
    let mut order = Vec::with_capacity(pattern.sites());
    let mut queue = VecDeque::new();
    for &site in &junctions {
        reached[site] = true;
        queue.push_back(site);
    }
    for start in 0..pattern.sites() {
        while let Some(site) = queue.pop_front() {
            order.push(site);
            for &neighbour in pattern.row(site) {
                if !reached[neighbour] {
                    reached[neighbour] = true;
                    queue.push_back(neighbour);
                }
            }
        }
        if !reached[start] {
            reached[start] = true;
            queue.push_back(start);
        }
    }
    order.extend(queue);
    order
}
