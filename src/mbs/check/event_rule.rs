//! Checks of the rules about contacts and fractures.

use super::List;
use crate::mbs::model::{Model, Range, Trigger};
use std::collections::BTreeSet;

pub(super) fn check(model: &Model, known: &BTreeSet<&str>, list: &mut List) {
    list.unique("event_rules", model.event_rules.iter().map(|r| r.id.as_str()));
    let latent = model.bushings.iter().filter(|b| b.latent.is_some());
    let latent: BTreeSet<&str> = latent.map(|b| b.id.as_str()).collect();
    for (i, rule) in model.event_rules.iter().enumerate() {
        let path = format!("event_rules[{i}]");
        list.require(!rule.bodies.is_empty(), &format!("{path}.bodies"), || {
            "is empty, expected the bodies that the rule is about".into()
        });
        for (k, id) in rule.bodies.iter().enumerate() {
            list.known(known, id, &format!("{path}.bodies[{k}]"));
        }
        for (k, id) in rule.watch.iter().enumerate() {
            list.among(&latent, id, &format!("{path}.watch[{k}]"), "a latent bushing");
        }
        let asks_something = match &rule.on {
            Trigger::Contact { partners, approach_speed_m_s, .. } => {
                check_range(approach_speed_m_s, &format!("{path}.on.approach_speed_m_s"), list);
                ("partners", !partners.is_empty())
            }
            Trigger::Fracture { places, .. } => ("places", !places.is_empty()),
        };
        list.require(asks_something.1, &format!("{path}.on.{}", asks_something.0), || {
            "is empty, so that the rule never fires: name at least one".into()
        });
        check_range(&rule.on.time_s(), &format!("{path}.on.time_s"), list);
    }
}

fn check_range(range: &Range, path: &str, list: &mut List) {
    let ends: Vec<f64> = [range.least, range.most].into_iter().flatten().collect();
    list.finite(path, &ends);
    list.require(ends.windows(2).all(|e| e[0] <= e[1]), path, || {
        format!("is from {} to {}, which holds no number", ends[0], ends[1])
    });
}
