//! Circles among arrows.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::modules::{Arrows, Module};

/// Returns the circles: from a module along arrows back to it, each written `a → b → a`, the
/// shortest for a module that has one. A module that is on a circle already found is not searched
/// again. The root of a crate is left out, because it names all modules and holds what they share.
pub(crate) fn circles(arrows: &Arrows) -> Vec<String> {
    let mut seen: BTreeSet<&Module> = BTreeSet::new();
    let mut circles = Vec::new();
    for module in arrows.keys() {
        if module.is_empty() || seen.contains(module) {
            continue;
        }
        if let Some(circle) = circle_of(arrows, module) {
            let names: Vec<String> = circle.iter().map(|module| name(module)).collect();
            circles.push(names.join(" → "));
            seen.extend(circle);
        }
    }
    circles
}

/// Returns the shortest way from a module along arrows back to it.
fn circle_of<'a>(arrows: &'a Arrows, module: &'a Module) -> Option<Vec<&'a Module>> {
    let mut came_from: BTreeMap<&Module, &Module> = BTreeMap::new();
    let mut next = VecDeque::from([module]);
    while let Some(here) = next.pop_front() {
        let targets = arrows.get(here).into_iter().flatten();
        for target in targets.filter(|target| !target.is_empty()) {
            if target == module {
                let mut circle = vec![module, here];
                let mut last = here;
                while last != module {
                    last = came_from[last];
                    circle.push(last);
                }
                if here == module {
                    circle.pop();
                }
                circle.reverse();
                return Some(circle);
            }
            if !came_from.contains_key(target) {
                came_from.insert(target, here);
                next.push_back(target);
            }
        }
    }
    None
}

/// Returns the same arrows between the modules of the top level, each with all modules below it.
pub(crate) fn of_the_top_level(arrows: &Arrows) -> Arrows {
    let top = |module: &Module| module.first().map(|first| vec![first.clone()]);
    let mut between = Arrows::new();
    for (module, targets) in arrows {
        let Some(from) = top(module) else { continue };
        let others = targets.iter().filter_map(top).filter(|to| *to != from);
        between.entry(from.clone()).or_default().extend(others);
    }
    between
}

/// Returns the arrows from a module, or one below it, to another or one below that, each written
/// `a → b`.
pub(crate) fn between(arrows: &Arrows, from: &str, to: &str) -> Vec<String> {
    let [from, to] = [from, to].map(|path| path.split("::").map(str::to_owned).collect::<Module>());
    let mut found = Vec::new();
    for (module, targets) in arrows
        .iter()
        .filter(|(module, _)| module.starts_with(&from))
    {
        for target in targets.iter().filter(|target| target.starts_with(&to)) {
            found.push(format!("{} → {}", name(module), name(target)));
        }
    }
    found
}

fn name(module: &Module) -> String {
    module.join("::")
}
