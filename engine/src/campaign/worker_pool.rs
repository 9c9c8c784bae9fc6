//! Many jobs on some threads, their results in the order in which they come.

use std::sync::{Mutex, PoisonError};
use std::thread;

use crossbeam_channel::bounded;

/// Results that may wait for who takes them.
const WAITING: usize = 256;

/// Does a job for each of `indices` on `workers` threads; `take` is called on this thread, and what it refuses
/// ends the work: jobs under way are finished and dropped.
///
/// # Errors
/// What `take` refused with.
pub fn do_all<T: Send, E>(
    indices: impl Iterator<Item = u64> + Send,
    workers: usize,
    job: impl Fn(u64) -> T + Sync,
    mut take: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let indices = Mutex::new(indices);
    let next = || {
        // What may have panicked is a job, not who holds the lock.
        let mut indices = indices.lock().unwrap_or_else(PoisonError::into_inner);
        indices.next()
    };
    thread::scope(|scope| {
        let (sender, receiver) = bounded(WAITING);
        for _ in 0..workers.max(1) {
            let (sender, next, job) = (sender.clone(), &next, &job);
            scope.spawn(move || {
                while let Some(index) = next() {
                    // Nobody takes results any more.
                    if sender.send(job(index)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        receiver.into_iter().try_for_each(&mut take)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_done_once() {
        for workers in [1, 2, 5] {
            let mut found = Vec::new();
            let done: Result<(), ()> = do_all(
                0..1000,
                workers,
                |k| k * k,
                |square| {
                    found.push(square);
                    Ok(())
                },
            );
            assert_eq!(done, Ok(()));
            found.sort_unstable();
            assert!(
                found
                    .iter()
                    .zip(0..1000)
                    .all(|(square, k)| *square == k * k)
            );
            assert_eq!(found.len(), 1000);
        }
    }

    #[test]
    fn a_refusal_ends_the_work() {
        let mut taken = 0;
        let done = do_all(
            0..100_000,
            2,
            |k| k,
            |_| {
                taken += 1;
                if taken == 10 { Err("full") } else { Ok(()) }
            },
        );
        assert_eq!((done, taken), (Err("full"), 10));
    }
}
