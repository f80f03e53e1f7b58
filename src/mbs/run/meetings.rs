//! Which contacts of bodies are ones that begin: a body meets another one once, and rests on it from then on.

use crate::mbs::contact::Partner;

/// Bodies that have not touched for so long meet anew when they do \[s\]: a blow is spread over some steps, and points of what lies still may lift off for one.
const PAUSE_S: f64 = 0.02;
/// Speeds that gravity adds in so many steps are those of bodies at rest on each other.
const STEPS_AT_REST: f64 = 4.0;

/// The meetings that go on.
#[derive(Default)]
pub(super) struct Meetings {
    list: Vec<Meeting>,
}

struct Meeting {
    /// Bodies of the file that the body was made of: it may have parted since.
    body: Vec<usize>,
    with: With,
    /// The fastest approach so far \[m/s\].
    fastest_m_s: f64,
    last_s: f64,
}

/// What a body meets, as [`Partner`], by bodies of the file.
#[derive(PartialEq)]
enum With {
    Body(Vec<usize>),
    Other(Partner),
}

/// An approach in a step of a run.
pub(super) struct Approach {
    /// Along the normal \[m/s\].
    pub speed_m_s: f64,
    /// Begin of the step \[s\].
    pub time_s: f64,
    /// What gravity adds in a step \[m/s\].
    pub added_m_s: f64,
}

impl Meetings {
    /// Ends those that nothing has been seen of for a while, but for bodies that `sleep`.
    pub fn end(&mut self, time_s: f64, sleep: impl Fn(&[usize]) -> bool) {
        for meeting in &mut self.list {
            if sleep(&meeting.body) {
                meeting.last_s = time_s;
            }
        }
        self.list.retain(|m| time_s - m.last_s <= PAUSE_S);
    }

    /// Enters a contact of a body; whether it is one that begins, or the hardest so far of one that goes on.
    pub fn is_news(
        &mut self,
        body: usize,
        partner: Partner,
        pieces: &[Vec<usize>],
        approach: &Approach,
    ) -> bool {
        let at_rest_m_s = STEPS_AT_REST * approach.added_m_s;
        let with = With::of(partner, pieces);
        let known = self.list.iter_mut().find(|m| share(&m.body, &pieces[body]) && m.with.is_part_of(&with));
        let Some(known) = known else {
            let meeting = Meeting {
                body: pieces[body].clone(),
                with,
                fastest_m_s: approach.speed_m_s,
                last_s: approach.time_s,
            };
            self.list.push(meeting);
            // what touches from the start, at rest, does not meet
            return approach.time_s > 0.0 || approach.speed_m_s > at_rest_m_s;
        };
        known.last_s = approach.time_s;
        let is_harder = approach.speed_m_s > known.fastest_m_s.max(at_rest_m_s);
        known.fastest_m_s = known.fastest_m_s.max(approach.speed_m_s);
        is_harder
    }
}

impl With {
    fn of(partner: Partner, pieces: &[Vec<usize>]) -> Self {
        match partner {
            Partner::Body(other) => Self::Body(pieces[other].clone()),
            other => Self::Other(other),
        }
    }

    fn is_part_of(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Body(a), Self::Body(b)) => share(a, b),
            (a, b) => a == b,
        }
    }
}

fn share(a: &[usize], b: &[usize]) -> bool {
    a.iter().any(|i| b.contains(i))
}
