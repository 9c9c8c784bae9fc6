//! The name that was probably meant.

use strsim::damerau_levenshtein;

/// The words of which the units at the end of a name are made: `_kg_m3`, `_n_s_m`, `_rad_s`.
const UNIT_WORDS: [&str; 34] = [
    "m", "m2", "m3", "mm", "km", "kg", "g", "s", "s2", "h", "day", "days", "rad", "deg", "n", "nm",
    "pa", "k", "c", "j", "w", "wh", "v", "a", "hz", "per", "min", "kn", "kpa", "bar", "mol", "kw",
    "kj", "kmh",
];

/// The candidate that `name` was probably meant to be, if one is near enough: the same but for
/// capitals, the same without its unit, at most a third of the letters wrong, or the only one
/// that begins with it.
#[must_use]
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let candidates: Vec<&str> = candidates.into_iter().collect();
    let wanted = name.to_lowercase();
    let same = candidates.iter().find(|c| c.to_lowercase() == wanted);
    if let Some(same) = same {
        return Some(same);
    }
    if let Some(with_unit) = candidates.iter().find(|c| lacks_unit(name, c)) {
        return Some(with_unit);
    }
    let allowed = (wanted.chars().count() / 3).max(1);
    let closest = (candidates.iter())
        .map(|c| (damerau_levenshtein(&wanted, &c.to_lowercase()), c))
        .filter(|&(wrong, c)| wrong <= allowed && wrong < c.chars().count())
        .min_by_key(|&(wrong, _)| wrong);
    if let Some((_, closest)) = closest {
        return Some(closest);
    }
    let mut longer = (candidates.iter())
        .filter(|c| wanted.chars().count() >= 3 && c.to_lowercase().starts_with(&wanted));
    match (longer.next(), longer.next()) {
        (Some(only), None) => Some(only),
        _ => None,
    }
}

/// True if `full` is `name` followed by a unit: `mass` and `mass_kg`, `density` and
/// `density_kg_m3`.
#[must_use]
pub fn lacks_unit(name: &str, full: &str) -> bool {
    let (name, full) = (name.to_lowercase(), full.to_lowercase());
    let unit = full.strip_prefix(&name).and_then(|u| u.strip_prefix('_'));
    !name.is_empty() && unit.is_some_and(|u| u.split('_').all(|w| UNIT_WORDS.contains(&w)))
}

#[cfg(test)]
mod tests;
