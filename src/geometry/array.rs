//! [`Array`]: an immutable array, owned or within bytes that others hold, as a baked file mapped into memory.
//!
//! ```text
//!     Array   pointer, length | holder ---> Vec<T>                         an array of its own
//!                                      \-> Arc of bytes and a range        a section of a file, used in place
//! ```
//!
//! Reading an element costs what it costs in a `Vec`: pointer and length lie in the array itself. Clones share.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use yoke::Yoke;

/// Bytes of a file, held by anything: a vector, a memory map, a static.
#[cfg(feature = "io")]
pub(crate) type SharedBytes = Arc<dyn AsRef<[u8]> + Send + Sync>;

/// What keeps the elements of an [`Array`] alive.
trait Hold<T>: Send + Sync {
    fn elements(&self) -> &[T];

    /// Takes the elements out as a vector, if the holder is a vector.
    fn take(&mut self) -> Option<Vec<T>>;
}

impl<T: Send + Sync> Hold<T> for Vec<T> {
    fn elements(&self) -> &[T] {
        self
    }

    fn take(&mut self) -> Option<Vec<T>> {
        Some(std::mem::take(self))
    }
}

/// A range of shared bytes.
#[cfg(feature = "io")]
struct Section {
    bytes: SharedBytes,
    range: std::ops::Range<usize>,
}

#[cfg(feature = "io")]
impl<T: bytemuck::AnyBitPattern + Send + Sync> Hold<T> for Section {
    /// Empty if the range is not in the bytes, or not aligned: [`Array::within`] has looked at the address before, and a
    /// holder that moves its bytes is not worth a panic.
    fn elements(&self) -> &[T] {
        let bytes = (*self.bytes).as_ref().get(self.range.clone());
        bytes.and_then(|bytes| bytemuck::try_cast_slice(bytes).ok()).unwrap_or_default()
    }

    fn take(&mut self) -> Option<Vec<T>> {
        None
    }
}

/// An immutable array, owned or within shared bytes. Derefs to a slice at the cost of a `Vec`.
pub(crate) struct Array<T: 'static>(Yoke<&'static [T], Arc<dyn Hold<T>>>);

impl<T: 'static> Array<T> {
    fn held(holder: Arc<dyn Hold<T>>) -> Self {
        Self(Yoke::attach_to_cart(holder, |holder| holder.elements()))
    }

    /// Returns the elements as a vector: without a copy if no clone shares them and they are not within shared bytes.
    pub fn into_vec(self) -> Vec<T>
    where
        T: Clone,
    {
        let mut holder = self.0.into_backing_cart();
        match Arc::get_mut(&mut holder).and_then(|holder| holder.take()) {
            Some(vec) => vec,
            None => holder.elements().to_vec(),
        }
    }
}

impl<T: Clone + Send + Sync + 'static> Array<T> {
    /// Changes the elements as a vector. Copies them if a clone shares them or they are within shared bytes.
    pub fn edit<R>(&mut self, edit: impl FnOnce(&mut Vec<T>) -> R) -> R {
        let mut vec = std::mem::take(self).into_vec();
        let result = edit(&mut vec);
        *self = vec.into();
        result
    }
}

#[cfg(feature = "io")]
impl<T: bytemuck::AnyBitPattern + Send + Sync> Array<T> {
    /// Makes an array of a range of shared bytes; `None` if the range does not exist or does not hold whole aligned elements.
    pub fn within(bytes: &SharedBytes, range: std::ops::Range<usize>) -> Option<Self> {
        let found = (**bytes).as_ref().get(range.clone())?;
        let count = bytemuck::try_cast_slice::<u8, T>(found).ok()?.len();
        let array = Self::held(Arc::new(Section { bytes: Arc::clone(bytes), range }));
        (array.len() == count).then_some(array)
    }
}

impl<T> Deref for Array<T> {
    type Target = [T];

    #[inline]
    fn deref(&self) -> &[T] {
        self.0.get()
    }
}

impl<T: Send + Sync> From<Vec<T>> for Array<T> {
    fn from(elements: Vec<T>) -> Self {
        Self::held(Arc::new(elements))
    }
}

impl<T: Send + Sync> FromIterator<T> for Array<T> {
    fn from_iter<I: IntoIterator<Item = T>>(elements: I) -> Self {
        elements.into_iter().collect::<Vec<T>>().into()
    }
}

impl<T: Send + Sync> Default for Array<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> Clone for Array<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<T: PartialEq> PartialEq for Array<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: Eq> Eq for Array<T> {}

impl<T: fmt::Debug> fmt::Debug for Array<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<'a, T> IntoIterator for &'a Array<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

#[cfg(feature = "serde")]
impl<T: serde::Serialize> serde::Serialize for Array<T> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        (**self).serialize(serializer)
    }
}

#[cfg(feature = "serde")]
impl<'de, T: serde::Deserialize<'de> + Send + Sync> serde::Deserialize<'de> for Array<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(Self::from)
    }
}

#[cfg(test)]
mod tests {
    use super::Array;

    #[test]
    fn a_vector_goes_in_and_out_without_a_copy() {
        let vec = vec![1_u32, 2, 3];
        let place = vec.as_ptr();
        let array = Array::from(vec);
        assert_eq!((array.as_ptr(), &array[..]), (place, &[1, 2, 3][..]));
        let clone = array.clone();
        assert_eq!(clone.as_ptr(), place);
        let mut array = {
            drop(clone);
            array
        };
        array.edit(|vec| vec[0] = 7);
        let vec = array.into_vec();
        assert_eq!((vec.as_ptr(), &vec[..]), (place, &[7, 2, 3][..]));
    }

    #[test]
    fn clones_are_not_edited() {
        let mut array = Array::from(vec![1_u32, 2]);
        let clone = array.clone();
        array.edit(|vec| vec.push(3));
        assert_eq!((&array[..], &clone[..]), (&[1, 2, 3][..], &[1, 2][..]));
    }

    #[cfg(feature = "io")]
    #[test]
    fn sections_lie_in_the_bytes() {
        use std::sync::Arc;
        let bytes: super::SharedBytes = Arc::new(bytemuck::cast_slice::<u64, u8>(&[1, 2, 3, 4]).to_vec());
        let start = (*bytes).as_ref().as_ptr();
        let array = Array::<u64>::within(&bytes, 8..24).expect("allocations are aligned");
        assert_eq!(&array[..], [2_u64.to_le(), 3_u64.to_le()]);
        assert_eq!(array.as_ptr().cast::<u8>(), start.wrapping_add(8));
        assert!(
            Array::<u64>::within(&bytes, 8..20).is_none() && Array::<u64>::within(&bytes, 4..12).is_none()
        );
        assert!(Array::<u64>::within(&bytes, 24..40).is_none());
        assert_eq!(array.into_vec(), [2, 3]);
    }
}
