//! Which technique fills each role, with which parameters, and which one it is compared with.
//!
//! Everything here comes from the registry of techniques: no technique is known by name.

use kajo_lab::Pictured;
use kajo_params::ParamValues;
use kajo_renderer::RoleSelection;
use kajo_techniques::{Role, Technique, default_of};
use std::collections::BTreeMap;

/// A technique with its parameters.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    /// The technique.
    pub technique: &'static Technique,
    /// Its parameters.
    pub params: ParamValues,
}

impl PartialEq for Choice {
    fn eq(&self, other: &Self) -> bool {
        self.technique.id == other.technique.id && self.params == other.params
    }
}

impl Choice {
    /// With the defaults of all parameters.
    pub fn new(technique: &'static Technique) -> Self {
        Self { technique, params: ParamValues::defaults(technique.params) }
    }

    /// `ID[:param=value,…]`, parameters at their defaults left out.
    pub fn words(&self) -> String {
        let changed = self.params.iter().filter(|(spec, value)| spec.default != *value);
        let pairs: Vec<String> = changed.map(|(spec, value)| format!("{}={value}", spec.name)).collect();
        if pairs.is_empty() { self.technique.id.to_owned() } else { format!("{}:{}", self.technique.id, pairs.join(",")) }
    }
}

/// The choices of both sides.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Selection {
    /// A technique for each role that has any.
    pub chosen: BTreeMap<Role, Choice>,
    /// The role that is judged.
    pub judged: Role,
    /// What stands against the choice for that role.
    pub rival: Choice,
}

/// Roles that at least one technique fills.
pub(crate) fn filled_roles() -> impl Iterator<Item = Role> {
    Role::ALL.into_iter().filter(|&role| kajo_techniques::of_role(role).next().is_some())
}

/// Those of them that the path tracer can judge.
pub(crate) fn judged_roles() -> impl Iterator<Item = Role> {
    filled_roles().filter(|role| kajo_lab::judged_roles().any(|id| id == role.id()))
}

impl Default for Selection {
    fn default() -> Self {
        let default = |role| Some((role, Choice::new(default_of(role)?)));
        let judged = judged_roles().next().expect("a role that is filled and judged");
        Self { chosen: filled_roles().filter_map(default).collect(), judged, rival: Self::first_rival(judged) }
    }
}

impl Selection {
    /// The first technique of a role that is not its default.
    fn first_rival(role: Role) -> Choice {
        let default = default_of(role).map(|technique| technique.id);
        let other = kajo_techniques::of_role(role).find(|technique| Some(technique.id) != default);
        Choice::new(other.or_else(|| kajo_techniques::of_role(role).next()).expect("a filled role"))
    }

    /// Judges another role; its rival starts anew.
    pub fn judge(&mut self, role: Role) {
        if role != self.judged {
            (self.judged, self.rival) = (role, Self::first_rival(role));
        }
    }

    /// The choice that is judged.
    pub fn champion(&self) -> &Choice {
        &self.chosen[&self.judged]
    }

    /// The light that a picture of side A aims at: all of it once a technique gathers what has bounced, else what lights and the environment give straight.
    pub fn light(&self) -> Pictured {
        let bounces = [Role::DiffuseIndirect, Role::SpecularIndirect];
        let gathers =
            |role: &Role| self.chosen.get(role).map(|choice| choice.technique.id) != default_of(*role).map(|technique| technique.id);
        if bounces.contains(&self.judged) || bounces.iter().any(gathers) { Pictured::Whole } else { Pictured::Direct }
    }

    /// For the renderer: side A.
    pub fn roles(&self) -> RoleSelection {
        self.chosen.values().fold(RoleSelection::new(), |roles, choice| roles.with(choice.technique, choice.params.clone()))
    }

    /// For the renderer: side B, which differs in the judged role.
    pub fn rival_roles(&self) -> RoleSelection {
        self.roles().with(self.rival.technique, self.rival.params.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_filled_role_has_its_default_and_the_rival_is_another() {
        let selection = Selection::default();
        for role in filled_roles() {
            assert_eq!(selection.chosen[&role].technique.id, default_of(role).unwrap().id);
        }
        assert_ne!(selection.rival.technique.id, selection.champion().technique.id);
        assert_eq!(selection.rival.technique.role, selection.judged);
    }

    #[test]
    fn words_leave_defaults_out_and_are_read_back() {
        for technique in kajo_techniques::all() {
            let choice = Choice::new(technique);
            assert_eq!(choice.words(), technique.id);
            let (found, params) = kajo_techniques::parse(&choice.words()).unwrap();
            assert!(Choice { technique: found, params } == choice);
        }
        let (technique, params) = kajo_techniques::parse("shadow/ray-traced:samples=3").unwrap();
        assert_eq!(Choice { technique, params }.words(), "shadow/ray-traced:samples=3");
    }

    #[test]
    fn the_rival_replaces_the_judged_role_only() {
        let selection = Selection::default();
        let roles = selection.rival_roles();
        for role in filled_roles() {
            let expected = if role == selection.judged { &selection.rival } else { &selection.chosen[&role] };
            assert_eq!(roles.technique(role).unwrap().id, expected.technique.id);
        }
    }
}
