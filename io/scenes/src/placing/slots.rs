//! Values that are kept with what they were made of.

use std::collections::BTreeMap;

/// Values by number, each with what it was made of.
#[derive(Debug)]
pub(crate) struct Slots<K, V>(BTreeMap<usize, (K, V)>);

impl<K, V> Default for Slots<K, V> {
    fn default() -> Self {
        Self(BTreeMap::new())
    }
}

impl<K: PartialEq, V: Clone> Slots<K, V> {
    /// The value of a number: the one that is kept, or a new one if there is none that was made of the same.
    pub(crate) fn get<E>(
        &mut self,
        number: usize,
        made_of: K,
        make: impl FnOnce(&K) -> Result<V, E>,
    ) -> Result<V, E> {
        if let Some((kept, value)) = self.0.get(&number)
            && *kept == made_of
        {
            return Ok(value.clone());
        }
        let value = make(&made_of)?;
        self.0.insert(number, (made_of, value.clone()));
        Ok(value)
    }
}
