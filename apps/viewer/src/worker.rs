//! A thread that works on the latest question only.
//!
//! The window asks and goes on; the answer comes when it comes. A question that was not begun is replaced by a newer one, and work that takes
//! long looks at [`Desk::superseded`] now and then and gives up when something newer waits.

use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

/// Called when an answer is there.
pub(crate) type Wake = Arc<dyn Fn() + Send + Sync>;

/// The window's side of a thread.
pub(crate) struct Worker<Q, A> {
    shared: Arc<Shared<Q, A>>,
    thread: Option<JoinHandle<()>>,
}

/// The thread's side: where answers go.
pub(crate) struct Desk<Q, A> {
    shared: Arc<Shared<Q, A>>,
    wake: Wake,
}

struct Shared<Q, A> {
    state: Mutex<State<Q, A>>,
    changed: Condvar,
}

struct State<Q, A> {
    question: Option<Q>,
    answers: VecDeque<A>,
    working: bool,
    cancelled: bool,
    closed: bool,
}

impl<Q, A> Shared<Q, A> {
    fn lock(&self) -> MutexGuard<'_, State<Q, A>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<Q: Send + 'static, A: Send + 'static> Worker<Q, A> {
    /// Starts a thread that makes its tools once and then answers with them.
    pub fn new<T>(
        name: &str,
        wake: Wake,
        tools: impl FnOnce() -> T + Send + 'static,
        answer: impl Fn(&mut T, Q, &Desk<Q, A>) + Send + 'static,
    ) -> Self {
        let state = State { question: None, answers: VecDeque::new(), working: false, cancelled: false, closed: false };
        let shared = Arc::new(Shared { state: Mutex::new(state), changed: Condvar::new() });
        let desk = Desk { shared: shared.clone(), wake };
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            let mut tools = tools();
            while let Some(question) = desk.next() {
                answer(&mut tools, question, &desk);
            }
        });
        Self { shared, thread: thread.ok() }
    }

    /// Asks; a question that was not begun is forgotten.
    pub fn ask(&self, question: Q) {
        self.shared.lock().question = Some(question);
        self.shared.changed.notify_all();
    }

    /// Gives up what was asked and what is worked on.
    pub fn cancel(&self) {
        let mut state = self.shared.lock();
        (state.question, state.cancelled) = (None, true);
    }

    /// The answers since the last call, oldest first.
    pub fn answers(&self) -> VecDeque<A> {
        std::mem::take(&mut self.shared.lock().answers)
    }

    /// True when nothing is asked, worked on, or waiting to be read.
    pub fn is_idle(&self) -> bool {
        let state = self.shared.lock();
        self.has_ended() || (state.question.is_none() && !state.working && state.answers.is_empty())
    }

    /// True when the thread is no more: it could not be started, or a bug ended it.
    pub fn has_ended(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }
}

impl<Q, A> Drop for Worker<Q, A> {
    /// Waits for the thread, which gives up what it works on.
    fn drop(&mut self) {
        self.shared.lock().closed = true;
        self.shared.changed.notify_all();
        if let Some(thread) = self.thread.take() {
            // It ended by a panic, which has been printed.
            let _ = thread.join();
        }
    }
}

impl<Q, A> Desk<Q, A> {
    /// The next question; `None` when the window is gone.
    fn next(&self) -> Option<Q> {
        let mut state = self.shared.lock();
        state.working = false;
        loop {
            if state.closed {
                return None;
            }
            if let Some(question) = state.question.take() {
                (state.working, state.cancelled) = (true, false);
                return Some(question);
            }
            drop(state);
            // Whoever waits for this thread to be idle looks again.
            (self.wake)();
            state = self.shared.lock();
            while state.question.is_none() && !state.closed {
                state = self.shared.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
            }
        }
    }

    /// Gives an answer; a question may have several.
    pub fn answer(&self, answer: A) {
        self.shared.lock().answers.push_back(answer);
        (self.wake)();
    }

    /// True when the question that is worked on no longer matters.
    pub fn superseded(&self) -> bool {
        let state = self.shared.lock();
        state.closed || state.cancelled || state.question.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;
    use std::time::{Duration, Instant};

    fn settle<Q: Send + 'static, A: Send + 'static>(worker: &Worker<Q, A>) -> Vec<A> {
        let (mut answers, start) = (Vec::new(), Instant::now());
        while !worker.is_idle() {
            assert!(start.elapsed() < Duration::from_secs(20), "it does not come to rest");
            answers.extend(worker.answers());
            std::thread::yield_now();
        }
        answers.extend(worker.answers());
        answers
    }

    #[test]
    fn only_the_latest_of_the_questions_that_were_not_begun_is_answered() {
        let (begin, begun) = mpsc::channel::<()>();
        let (go, gone) = mpsc::channel::<()>();
        let worker = Worker::new(
            "test",
            Arc::new(|| ()),
            move || (begin, gone),
            |(begin, gone), question: u32, desk| {
                begin.send(()).unwrap();
                gone.recv().unwrap();
                desk.answer(question);
            },
        );
        worker.ask(1);
        begun.recv().unwrap();
        (2..10).for_each(|question| worker.ask(question));
        (0..2).for_each(|_| go.send(()).unwrap());
        assert_eq!(settle(&worker), [1, 9]);
    }

    #[test]
    fn long_work_gives_up_for_a_newer_question_and_for_the_end() {
        let worker = Worker::new(
            "test",
            Arc::new(|| ()),
            || (),
            |(), question: u32, desk| {
                while question == 0 && !desk.superseded() {
                    std::thread::yield_now();
                }
                desk.answer(question);
            },
        );
        worker.ask(0);
        worker.ask(7);
        assert_eq!(settle(&worker).last(), Some(&7));
        worker.ask(0);
        worker.cancel();
        settle(&worker);
        worker.ask(0);
        // Waits for the thread: would never end if it did not give up.
        drop(worker);
    }

    #[test]
    fn a_thread_that_a_bug_ended_is_idle_and_says_so() {
        let worker = Worker::new("test", Arc::new(|| ()), || (), |(), (), _: &Desk<(), ()>| panic!("a planted bug"));
        worker.ask(());
        let start = Instant::now();
        while !worker.has_ended() {
            assert!(start.elapsed() < Duration::from_secs(20));
            std::thread::yield_now();
        }
        assert!(worker.is_idle());
    }
}
