//! Cache of a tab's results within a memory budget; the least recently used entry is dropped first. On request, logs
//! are read again from the project folder and comparisons are computed again.

use std::sync::{Arc, Mutex};

use recording::Recording;

use crate::lock::lock;

/// Values of a tab in memory, 8 bytes each: a third of its memory limit.
pub(crate) const VALUES_MAX: usize = 128 << 20;

/// Budget that several caches share.
pub(crate) struct Room {
    values_max: usize,
    entries: Mutex<Entries>,
}

#[derive(Default)]
struct Entries {
    /// Entries, the least recently used first.
    entries: Vec<Entry>,
    shelves: u64,
}

struct Entry {
    cache: u64,
    number: u32,
    values: usize,
    thing: Thing,
}

type Thing = Arc<dyn std::any::Any + Send + Sync>;

/// Results of one kind of one tab, by number.
pub(crate) struct Cache<T> {
    room: Arc<Room>,
    number: u64,
    kind: std::marker::PhantomData<fn() -> T>,
}

impl Room {
    pub(crate) fn new(values_max: usize) -> Self {
        Self {
            values_max,
            entries: Mutex::default(),
        }
    }
}

impl<T: Send + Sync + 'static> Cache<T> {
    pub(crate) fn in_room(room: &Arc<Room>) -> Self {
        let mut entries = lock(&room.entries);
        entries.shelves += 1;
        Self {
            room: Arc::clone(room),
            number: entries.shelves,
            kind: std::marker::PhantomData,
        }
    }

    pub(crate) fn get(&self, number: u32) -> Option<Arc<T>> {
        let entries = &mut lock(&self.room.entries).entries;
        let mine = |entry: &Entry| entry.cache == self.number && entry.number == number;
        let entry = entries.remove(entries.iter().position(mine)?);
        let thing = Arc::clone(&entry.thing);
        entries.push(entry);
        thing.downcast().ok()
    }

    /// Stores a result with this number of values. It stays at least until the next result is stored, for any size.
    pub(crate) fn put(&self, number: u32, values: usize, thing: Arc<T>) {
        self.remove(number);
        let entries = &mut lock(&self.room.entries).entries;
        entries.push(Entry {
            cache: self.number,
            number,
            values,
            thing,
        });
        let mut sum: usize = entries.iter().map(|entry| entry.values).sum();
        while sum > self.room.values_max && entries.len() > 1 {
            sum -= entries.remove(0).values;
        }
    }

    pub(crate) fn remove(&self, number: u32) {
        self.retain(|entry| entry.number != number);
    }

    pub(crate) fn clear(&self) {
        self.retain(|_| false);
    }

    fn retain(&self, stays: impl Fn(&Entry) -> bool) {
        let entries = &mut lock(&self.room.entries).entries;
        entries.retain(|entry| entry.cache != self.number || stays(entry));
    }
}

impl<T> Drop for Cache<T> {
    fn drop(&mut self) {
        let entries = &mut lock(&self.room.entries).entries;
        entries.retain(|entry| entry.cache != self.number);
    }
}

/// Returns the size of a recording: values of all signals and time bases.
pub(crate) fn values_of(recording: &Recording) -> usize {
    let of_signals = recording
        .signals()
        .iter()
        .map(|signal| signal.values_or_nan().len());
    let of_bases = recording.time_bases().map(|(_, base)| base.len());
    of_signals.chain(of_bases).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_used_longest_ago_makes_room_whoever_has_it() {
        let room = Arc::new(Room::new(10));
        let [one, other] = [Cache::in_room(&room), Cache::in_room(&room)];
        one.put(1, 4, Arc::new("a"));
        other.put(1, 4, Arc::new("b"));
        assert_eq!(one.get(1).as_deref(), Some(&"a"));
        one.put(2, 4, Arc::new("c"));
        assert_eq!(other.get(1), None);
        assert!(one.get(1).is_some() && one.get(2).is_some());
    }

    #[test]
    fn the_last_thing_stays_however_large_it_is() {
        let room = Arc::new(Room::new(10));
        let cache = Cache::in_room(&room);
        cache.put(1, 4, Arc::new(1));
        cache.put(2, 99, Arc::new(2));
        assert_eq!((cache.get(1), cache.get(2).as_deref()), (None, Some(&2)));
        cache.put(3, 1, Arc::new(3));
        assert_eq!((cache.get(2), cache.get(3).as_deref()), (None, Some(&3)));
    }

    #[test]
    fn a_tab_that_goes_leaves_its_room() {
        let room = Arc::new(Room::new(10));
        let (one, other) = (Cache::in_room(&room), Cache::in_room(&room));
        one.put(1, 5, Arc::new(()));
        other.put(1, 5, Arc::new(()));
        other.put(1, 4, Arc::new(()));
        drop(one);
        assert_eq!(lock(&room.entries).entries.len(), 1);
        other.clear();
        assert_eq!(other.get(1), None);
    }
}
