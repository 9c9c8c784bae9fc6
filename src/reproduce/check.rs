//! What a case claims, claim by claim: the paper's answer, ours, and one that does not come from the program.

use std::fmt;

/// An answer: a number in the unit of its check, or words.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// A number.
    Number(f64),
    /// Words.
    Words(String),
}

impl From<f64> for Answer {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Answer {
    fn from(words: &str) -> Self {
        Self::Words(words.to_owned())
    }
}

impl From<String> for Answer {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

/// Figures of a number for a reader.
const FIGURES: i32 = 6;

impl fmt::Display for Answer {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words(words) => formatter.write_str(words),
            Self::Number(number) => formatter.write_str(&figures(*number)),
        }
    }
}

/// A number with [`FIGURES`] figures, without the zeros at its end.
fn figures(number: f64) -> String {
    let size = number.abs();
    if size == 0.0 {
        // Minus zero reads as a difference where there is none.
        return "0".to_owned();
    }
    if !(1e-4..1e9).contains(&size) {
        let text = format!("{number:.2e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        let mantissa = mantissa.trim_end_matches('0').trim_end_matches('.');
        return format!("{mantissa}e{power}");
    }
    let decimals = (FIGURES - 1 - libm::floor(libm::log10(size)) as i32).max(0) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') {
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    text
}

/// An answer that does not come from the run that is checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Independent {
    /// The answer.
    pub answer: Answer,
    /// Where it comes from, in words: a closed form, a separate program, the other formulation.
    pub source: String,
}

/// How near a number must be to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// In the unit of the check.
    Absolute(f64),
    /// As a part of the expected number.
    Relative(f64),
}

impl Tolerance {
    fn allows(self, ours: f64, expected: f64) -> bool {
        // Nothing compares with a number that is none.
        match self {
            Self::Absolute(most) => (ours - expected).abs() <= most,
            Self::Relative(most) => (ours - expected).abs() <= most * expected.abs(),
        }
    }
}

/// One claim of a case, and whether it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// What is claimed.
    pub what: String,
    /// Unit of the numbers; empty for words and for numbers without one.
    pub unit: &'static str,
    /// What the paper has.
    pub paper: Option<Answer>,
    /// What the program has.
    pub ours: Answer,
    /// What else there is to compare with; without it the check is against the paper, or tells alone.
    pub independent: Option<Independent>,
    /// What is asked for, in words; empty where the check tells alone.
    pub asked: String,
    /// Whether that is so; a check that tells alone holds.
    pub holds: bool,
}

impl Check {
    /// A number or words, as yet compared with nothing.
    #[must_use]
    pub fn of(what: impl Into<String>, unit: &'static str, ours: impl Into<Answer>) -> Self {
        Self {
            what: what.into(),
            unit,
            paper: None,
            ours: ours.into(),
            independent: None,
            asked: String::new(),
            holds: true,
        }
    }

    /// With what the paper has.
    #[must_use]
    pub fn paper(mut self, answer: impl Into<Answer>) -> Self {
        self.paper = Some(answer.into());
        self
    }

    /// Our number must be near another.
    #[must_use]
    pub fn against(
        mut self,
        expected: f64,
        tolerance: Tolerance,
        source: impl Into<String>,
    ) -> Self {
        self.holds = self.number().is_some_and(|n| tolerance.allows(n, expected));
        self.asked = match tolerance {
            Tolerance::Absolute(most) => format!("within {} {}", figures(most), self.unit),
            Tolerance::Relative(most) => format!("within {} %", figures(100.0 * most)),
        };
        self.asked.truncate(self.asked.trim_end().len());
        self.independent = Some(Independent {
            answer: Answer::Number(expected),
            source: source.into(),
        });
        self
    }

    /// Our number must not be above a limit.
    #[must_use]
    pub fn at_most(mut self, most: f64, source: impl Into<String>) -> Self {
        self.holds = self.number().is_some_and(|number| number <= most);
        self.asked = format!("at most {} {}", figures(most), self.unit);
        self.asked.truncate(self.asked.trim_end().len());
        self.independent = Some(Independent {
            answer: Answer::Number(most),
            source: source.into(),
        });
        self
    }

    /// Our number, a difference, must vanish but for a remainder.
    #[must_use]
    pub fn vanishes(self, within: f64, source: impl Into<String>) -> Self {
        self.against(0.0, Tolerance::Absolute(within), source)
    }

    /// Our answer must be as another says in words; whether it is, the caller knows.
    #[must_use]
    pub fn as_said(
        mut self,
        answer: impl Into<Answer>,
        holds: bool,
        source: impl Into<String>,
    ) -> Self {
        self.holds = holds;
        self.asked = "the same".to_owned();
        self.independent = Some(Independent {
            answer: answer.into(),
            source: source.into(),
        });
        self
    }

    /// Compared with the paper alone: what is asked for, and whether it is so.
    #[must_use]
    pub fn as_in_paper(mut self, asked: impl Into<String>, holds: bool) -> Self {
        self.asked = asked.into();
        self.holds = holds;
        self
    }

    /// Whether it contradicts an answer other than the paper's.
    #[must_use]
    pub fn fails(&self) -> bool {
        self.independent.is_some() && !self.holds
    }

    /// An answer as a reader has it: a number with its unit, words as they are.
    #[must_use]
    pub fn told(&self, answer: &Answer) -> String {
        match answer {
            Answer::Number(_) => format!("{answer} {}", self.unit).trim_end().to_owned(),
            Answer::Words(words) => words.clone(),
        }
    }

    fn number(&self) -> Option<f64> {
        match self.ours {
            Answer::Number(number) => Some(number),
            Answer::Words(_) => None,
        }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}: {}", self.what, self.told(&self.ours))?;
        if let Some(Independent { answer, source }) = &self.independent {
            write!(formatter, "; {source}: {}", self.told(answer))?;
        }
        write!(formatter, "; asked for: {}", self.asked)
    }
}

/// What a case comes to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Whether every check against an answer other than the paper's holds.
    pub holds: bool,
    /// In what the program agrees with the paper and in what it differs, and why.
    pub sentence: String,
}

impl Verdict {
    /// The verdict of checks; without any it says that there is nothing to judge.
    #[must_use]
    pub fn of(checks: &[Check], sentence: impl Into<String>) -> Self {
        Self {
            holds: !checks.iter().any(Check::fails),
            sentence: if checks.is_empty() {
                "With these settings there is too little to judge.".to_owned()
            } else {
                sentence.into()
            },
        }
    }
}

/// The largest of some numbers; not a number where one of them is none, so that no check of it holds.
pub(super) fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(0.0, |most, number| {
        if number > most || number.is_nan() {
            number
        } else {
            most
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(ours: f64) -> Check {
        Check::of("length", "m", ours)
    }

    #[test]
    fn a_number_holds_within_its_tolerance_and_not_beyond() {
        let near = |ours| number(ours).against(2.0, Tolerance::Absolute(0.1), "by hand");
        assert!(near(2.05).holds && near(1.95).holds);
        assert!(near(2.2).fails() && near(1.8).fails() && near(f64::NAN).fails());
        let part = |ours| number(ours).against(-50.0, Tolerance::Relative(0.01), "by hand");
        assert!(part(-50.4).holds && part(-50.6).fails() && part(50.0).fails());
        assert!(number(3.0).at_most(3.0, "by hand").holds);
        assert!(number(1e-3).vanishes(1e-2, "by hand").holds);
        assert!(number(-1.0).vanishes(1e-2, "by hand").fails());
        assert!(number(f64::NAN).at_most(3.0, "by hand").fails());
        assert!(
            Check::of("length", "m", "long")
                .at_most(3.0, "by hand")
                .fails()
        );
    }

    /// A difference from the paper is told, and is no failure.
    #[test]
    fn only_an_independent_answer_can_fail_a_case() {
        let differs = number(1.0).paper(2.0).as_in_paper("the same", false);
        assert!(!differs.holds && !differs.fails());
        assert!(Verdict::of(std::slice::from_ref(&differs), "").holds);
        let wrong = number(1.0).at_most(0.5, "by hand");
        assert!(!Verdict::of(&[differs, wrong], "").holds);
    }

    #[test]
    fn a_failure_says_what_it_is() {
        let wrong = number(1.25).against(2.0, Tolerance::Relative(0.01), "the closed form");
        assert_eq!(
            wrong.to_string(),
            "length: 1.25 m; the closed form: 2 m; asked for: within 1 %"
        );
    }

    #[test]
    fn numbers_have_six_figures() {
        let text = |number: f64| Answer::Number(number).to_string();
        assert_eq!(text(123.456_789), "123.457");
        assert_eq!(text(1e6), "1000000");
        assert_eq!(text(-0.085_646_79), "-0.0856468");
        assert_eq!(text(1.234e-7), "1.23e-7");
        assert_eq!(text(-0.0), "0");
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan());
    }
}
