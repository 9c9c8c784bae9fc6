//! Cases on several threads, their reports in the order of the paper.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, mpsc};
use std::thread;
use std::time::Instant;

use aerobot_engine::plugin::Simulator;

use super::{Case, Report, ReproduceError, Settings};

/// A case that has come to its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Finished {
    /// Its name.
    pub name: &'static str,
    /// What it found.
    pub report: Report,
    /// The time it took, s; other cases may have run beside it.
    pub wall_s: f64,
}

/// Runs cases on so many threads, those that measure time alone and first. `take` gets what is finished in the
/// order of `cases`, on this thread; `progress` hears from any thread what is under way and what part of the
/// whole is done.
///
/// # Errors
/// Of the first case in order that is refused, or of `take`; cases that run by then come to their end, and
/// nothing that comes later is taken.
pub fn run_cases<E: From<ReproduceError>>(
    cases: &[Box<dyn Case>],
    simulator: &Simulator,
    settings: &Settings,
    threads: usize,
    progress: &(dyn Fn(&str, f64) + Sync),
    take: &mut dyn FnMut(Finished) -> Result<(), E>,
) -> Result<(), E> {
    let work = Work {
        cases,
        simulator,
        settings,
        parts: Mutex::new(vec![0.0; cases.len()]),
        progress,
    };
    let (timed, others): (Vec<usize>, Vec<usize>) =
        (0..cases.len()).partition(|index| cases[*index].measures_time());
    let mut done = Ordered {
        waiting: cases.iter().map(|_| None).collect(),
        next: 0,
    };
    for index in timed {
        done.waiting[index] = Some(work.run(index)?);
    }
    done.hand_over(take)?;
    let (next, refused) = (AtomicUsize::new(0), AtomicBool::new(false));
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        for _ in 0..threads.clamp(1, others.len().max(1)) {
            let sender = sender.clone();
            let (work, others, next, refused) = (&work, &others, &next, &refused);
            scope.spawn(move || {
                // A case that has been given out is run, so that of two that are refused the first is told.
                while !refused.load(Ordering::Relaxed)
                    && let Some(index) = others.get(next.fetch_add(1, Ordering::Relaxed))
                {
                    let result = work.run(*index);
                    refused.fetch_or(result.is_err(), Ordering::Relaxed);
                    if sender.send((*index, result)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let result = collect(receiver, &mut done, take);
        refused.fetch_or(result.is_err(), Ordering::Relaxed);
        result
    })
}

/// What the threads share.
struct Work<'a> {
    cases: &'a [Box<dyn Case>],
    simulator: &'a Simulator,
    settings: &'a Settings,
    /// The part of each case that is done.
    parts: Mutex<Vec<f64>>,
    progress: &'a (dyn Fn(&str, f64) + Sync),
}

impl Work<'_> {
    fn run(&self, index: usize) -> Result<Finished, ReproduceError> {
        let case = &self.cases[index];
        let start = Instant::now();
        let mut told = |what: &str, part: f64| {
            let whole = self.parts.lock().map_or(0.0, |mut parts| {
                parts[index] = part;
                parts.iter().sum::<f64>() / parts.len() as f64
            });
            (self.progress)(&format!("{}: {what}", case.name()), whole);
        };
        let report = case.run(self.simulator, self.settings, &mut told)?;
        told("done", 1.0);
        Ok(Finished {
            name: case.name(),
            report,
            wall_s: start.elapsed().as_secs_f64(),
        })
    }
}

/// What is finished, given on in order.
struct Ordered {
    waiting: Vec<Option<Finished>>,
    next: usize,
}

impl Ordered {
    /// Hands over what is finished up to the first that is not.
    fn hand_over<E>(&mut self, take: &mut dyn FnMut(Finished) -> Result<(), E>) -> Result<(), E> {
        while let Some(finished) = self.waiting.get_mut(self.next).and_then(Option::take) {
            self.next += 1;
            take(finished)?;
        }
        Ok(())
    }
}

fn collect<E: From<ReproduceError>>(
    receiver: mpsc::Receiver<(usize, Result<Finished, ReproduceError>)>,
    done: &mut Ordered,
    take: &mut dyn FnMut(Finished) -> Result<(), E>,
) -> Result<(), E> {
    let mut first_refused: Option<(usize, ReproduceError)> = None;
    for (index, result) in receiver {
        match result {
            Ok(finished) => {
                done.waiting[index] = Some(finished);
                done.hand_over(take)?;
            }
            Err(error) if first_refused.as_ref().is_none_or(|(at, _)| index < *at) => {
                first_refused = Some((index, error));
            }
            Err(_) => {}
        }
    }
    first_refused.map_or(Ok(()), |(_, error)| Err(error.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    /// Waits, and reports or refuses.
    struct Waiting {
        name: &'static str,
        wait_ms: u64,
        refuses: bool,
        is_timed: bool,
        running: &'static AtomicUsize,
    }

    impl Case for Waiting {
        fn name(&self) -> &'static str {
            self.name
        }

        fn about(&self) -> &'static str {
            ""
        }

        fn measures_time(&self) -> bool {
            self.is_timed
        }

        fn run(
            &self,
            _: &Simulator,
            _: &Settings,
            _: &mut dyn FnMut(&str, f64),
        ) -> Result<Report, ReproduceError> {
            self.running.fetch_add(1, Ordering::SeqCst);
            thread::sleep(Duration::from_millis(self.wait_ms));
            let beside = self.running.fetch_sub(1, Ordering::SeqCst) - 1;
            assert!(!self.is_timed || beside == 0, "time is measured alone");
            if self.refuses {
                return Err(ReproduceError::Setting(self.name.to_owned()));
            }
            Ok(Report::default())
        }
    }

    fn taken(cases: Vec<Waiting>, threads: usize) -> (Vec<&'static str>, Option<String>) {
        let cases: Vec<Box<dyn Case>> = cases
            .into_iter()
            .map(|case| Box::new(case) as Box<dyn Case>)
            .collect();
        let mut names = Vec::new();
        let result = run_cases::<ReproduceError>(
            &cases,
            &Simulator::new(),
            &Settings::default(),
            threads,
            &|_, _| {},
            &mut |finished| {
                names.push(finished.name);
                Ok(())
            },
        );
        (names, result.err().map(|error| error.to_string()))
    }

    fn case(name: &'static str, wait_ms: u64, running: &'static AtomicUsize) -> Waiting {
        Waiting {
            name,
            wait_ms,
            refuses: false,
            is_timed: false,
            running,
        }
    }

    #[test]
    fn reports_come_in_order_whatever_takes_longest() {
        static RUNNING: AtomicUsize = AtomicUsize::new(0);
        let cases = || {
            let mut timed = case("timed", 20, &RUNNING);
            timed.is_timed = true;
            let of = |name, wait_ms| case(name, wait_ms, &RUNNING);
            vec![of("slow", 60), timed, of("quick", 1), of("next", 5)]
        };
        for threads in [1, 2, 8] {
            let expected = vec!["slow", "timed", "quick", "next"];
            assert_eq!(taken(cases(), threads), (expected, None));
        }
        assert_eq!(taken(Vec::new(), 2), (Vec::new(), None));
    }

    #[test]
    fn the_first_in_order_that_is_refused_is_told() {
        static RUNNING: AtomicUsize = AtomicUsize::new(0);
        let refusing = |name, wait_ms| Waiting {
            refuses: true,
            ..case(name, wait_ms, &RUNNING)
        };
        let cases = vec![
            case("good", 1, &RUNNING),
            refusing("first", 60),
            refusing("second", 5),
            case("late", 1, &RUNNING),
        ];
        let (names, error) = taken(cases, 2);
        assert_eq!(names, ["good"]);
        assert_eq!(error.as_deref(), Some("error: first"));
    }
}
