//! The broadcast of the Newton matrix data with which ranks assemble their rows of `K̂`.

use crate::multigrid::form::Form;
use crate::multigrid::node::{Eliminated, WORDS};
use crate::ranks::World;

/// The data of a Newton matrix besides the stiffness.
#[derive(Clone)]
pub(crate) struct State {
    /// The factor of the stiffness.
    pub factor: f64,
    pub form: Form,
    /// The springs on the diagonal, by row.
    pub springs: Vec<(usize, f64)>,
    /// The contact nodes, by their numbers.
    pub contacts: Vec<(usize, Eliminated)>,
}

impl State {
    /// Broadcasts the state from rank 0, the only rank that has one. All ranks must call it.
    pub(super) fn told(own: Option<&State>, world: &World) -> Self {
        let mut head = own.map_or([0; 4], |state| {
            let oblique = i64::from(state.form == Form::Oblique);
            [state.factor.to_bits() as i64, oblique, state.springs.len() as i64, state.contacts.len() as i64]
        });
        world.tell(&mut head);
        let [factor, oblique, springs, contacts] = head;
        let mut words = vec![0; 2 * springs as usize + (1 + WORDS) * contacts as usize];
        if let Some(state) = own {
            let springs = state.springs.iter().flat_map(|(row, k)| [*row as i64, k.to_bits() as i64]);
            let contacts =
                state.contacts.iter().flat_map(|(node, contact)| [*node as i64].into_iter().chain(contact.words()));
            words.iter_mut().zip(springs.chain(contacts)).for_each(|(word, value)| *word = value);
        }
        world.tell(&mut words);
        let (springs, contacts) = words.split_at(2 * springs as usize);
        let contact = |words: &[i64; 1 + WORDS]| {
            let [node, rest @ ..] = words;
            (*node as usize, Eliminated::of_words(rest))
        };
        State {
            factor: f64::from_bits(factor as u64),
            form: if oblique == 0 { Form::Symmetric } else { Form::Oblique },
            springs: springs.as_chunks().0.iter().map(|[row, k]| (*row as usize, f64::from_bits(*k as u64))).collect(),
            contacts: contacts.as_chunks().0.iter().map(contact).collect(),
        }
    }
}
