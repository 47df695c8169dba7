//! Signals that a host measures, of the image and of the ECU.

use hil_protocol::{Measured, Refusal, SignalIds};

use crate::punctuality::{FIRST_SIGNAL, LAST_SIGNAL, Punctuality};

/// List of measured signals, in the order in which a host requested them.
#[derive(Clone, Debug)]
pub(crate) struct Measurement {
    ids: SignalIds,
}

impl Measurement {
    /// Creates an empty list.
    pub(crate) const fn new() -> Self {
        Self {
            ids: SignalIds::new(),
        }
    }

    /// Creates this list, if all of its signals that belong to the image exist.
    pub(crate) fn of(ids: &SignalIds, punctuality: &Punctuality) -> Result<Self, Refusal> {
        let unknown = |id: u16| id >= FIRST_SIGNAL && punctuality.signal(id).is_none();
        match ids.iter().find(|&&id| unknown(id)) {
            Some(&id) => Err(Refusal::UnknownSignal {
                id,
                last: LAST_SIGNAL,
            }),
            None => Ok(Self { ids: ids.clone() }),
        }
    }

    /// Returns whether the list is empty.
    pub(crate) fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }

    /// Returns the signals of the list that belong to the ECU.
    pub(crate) fn of_the_ecu(&self) -> SignalIds {
        let mut ids = SignalIds::new();
        for &id in self.ids.iter().filter(|&&id| id < FIRST_SIGNAL) {
            // The new list is at most as long as the given one.
            let _ = ids.push(id);
        }
        ids
    }

    /// Returns all values in the order of the list, given those of the ECU in their order.
    pub(crate) fn merged(&self, of_the_ecu: &Measured, punctuality: &Punctuality) -> Measured {
        let mut of_the_ecu = of_the_ecu.iter();
        let mut all = Measured::new();
        for &id in &self.ids {
            let value = punctuality
                .signal(id)
                .or_else(|| of_the_ecu.next().copied());
            if let Some(value) = value {
                // There is one value at most for each signal of the list.
                let _ = all.push(value);
            }
        }
        all
    }
}
