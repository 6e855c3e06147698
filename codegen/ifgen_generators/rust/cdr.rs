//! Reads and writes plain CDR (XCDR version 1) as Fast CDR does for ROS 2.

use std::borrow::Cow;
use std::fmt;

/// A message that cannot be encoded, or a payload that holds no such message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Error {
    /// The payload ends before this many bytes at this place.
    End { at: usize, wanted: usize },
    /// A sequence or an array with too many elements, or a string with too many characters.
    Bound { field: &'static str, most: usize },
    /// A string with a NUL in it.
    Nul { field: &'static str },
    /// Not UTF-16, at this place.
    Text { at: usize },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::End { at, wanted } => write!(f, "expected {wanted} bytes at {at}, where the payload ends"),
            Error::Bound { field, most } => write!(f, "{field}: expected at most {most} elements or characters"),
            Error::Nul { field } => write!(f, "{field}: expected a string without NUL"),
            Error::Text { at } => write!(f, "expected UTF-16 before {at}"),
        }
    }
}

impl std::error::Error for Error {}

/// The result of reading and writing.
pub type Result<T> = std::result::Result<T, Error>;

/// A message, or a part of a service or an action.
pub trait Message: Sized {
    /// `pkg/msg/Name`.
    const TYPE_NAME: &'static str;
    /// `RIHS01_...`.
    const TYPE_HASH: &'static str;

    /// Where the message ends that begins at position `p`, counted from after the header.
    fn end(&self, p: usize) -> usize;
    /// Append the message, without a header.
    fn write(&self, w: &mut Writer) -> Result<()>;
    /// Read a message, without a header.
    fn read(r: &mut Reader<'_>) -> Result<Self>;

    /// The size of its payload in bytes, with the header.
    fn encoded_len(&self) -> usize {
        4 + self.end(0)
    }
    /// Replace the contents of a buffer by the payload.
    fn encode_into(&self, out: &mut Vec<u8>) -> Result<()> {
        let mut w = Writer { out: std::mem::take(out) };
        w.out.clear();
        w.out.reserve(self.encoded_len());
        w.out.extend_from_slice(&[0, 1, 0, 0]);
        let result = self.write(&mut w);
        *out = w.out;
        result
    }
    /// The payload, with its 4-byte header.
    fn encode(&self) -> Result<Vec<u8>> {
        let mut out = Vec::new();
        self.encode_into(&mut out)?;
        Ok(out)
    }
    /// The message in a payload of either byte order. Ignores what follows it.
    fn decode(payload: &[u8]) -> Result<Self> {
        Self::read(&mut Reader::new(payload)?)
    }
}

/// A message that borrows its strings and arrays from the payload.
pub trait View<'a>: Sized {
    /// Read a message, without a header.
    fn read(r: &mut Reader<'a>) -> Result<Self>;
    /// The message in a payload of either byte order.
    fn decode(payload: &'a [u8]) -> Result<Self> {
        Self::read(&mut Reader::new(payload)?)
    }
}

/// A service, or a service of an action.
pub trait Service {
    /// `pkg/srv/Name`.
    const TYPE_NAME: &'static str;
    /// `RIHS01_...`.
    const TYPE_HASH: &'static str;
    type Request: Message;
    type Response: Message;
    type Event: Message;
}

/// An action.
pub trait Action {
    /// `pkg/action/Name`.
    const TYPE_NAME: &'static str;
    /// `RIHS01_...`.
    const TYPE_HASH: &'static str;
    type Goal: Message;
    type Result: Message;
    type Feedback: Message;
    type FeedbackMessage: Message;
    type SendGoal: Service;
    type GetResult: Service;
}

/// A number, a boolean, a byte or a character on the wire.
pub trait Number: Copy + Default {
    const SIZE: usize;
    /// The value in `SIZE` bytes.
    fn get(bytes: &[u8], big: bool) -> Self;
    /// Store the value in `SIZE` bytes, little endian.
    fn put(self, bytes: &mut [u8]);
    /// The values in these bytes.
    fn list(bytes: &[u8], big: bool) -> Vec<Self> {
        bytes.chunks_exact(Self::SIZE).map(|chunk| Self::get(chunk, big)).collect()
    }
    /// Append the values.
    fn append(values: &[Self], out: &mut Vec<u8>) {
        let start = out.len();
        out.resize(start + Self::SIZE * values.len(), 0);
        store(&mut out[start..], values);
    }
}

/// Store values, little endian.
pub fn store<T: Number>(bytes: &mut [u8], values: &[T]) {
    for (chunk, value) in bytes.chunks_exact_mut(T::SIZE).zip(values) {
        value.put(chunk);
    }
}

macro_rules! numbers {
    ($($type:ty)*) => {$(
        impl Number for $type {
            const SIZE: usize = std::mem::size_of::<$type>();
            #[inline]
            fn get(bytes: &[u8], big: bool) -> Self {
                let mut a = [0; Self::SIZE];
                a.copy_from_slice(bytes);
                if big { Self::from_be_bytes(a) } else { Self::from_le_bytes(a) }
            }
            #[inline]
            fn put(self, bytes: &mut [u8]) {
                bytes.copy_from_slice(&self.to_le_bytes());
            }
            // The byte order is asked once: each of both loops then becomes a copy of vectors.
            fn list(bytes: &[u8], big: bool) -> Vec<Self> {
                let chunks = bytes.chunks_exact(Self::SIZE);
                if big { chunks.map(|chunk| Self::get(chunk, true)).collect() } else { chunks.map(|chunk| Self::get(chunk, false)).collect() }
            }
        }
    )*};
}
numbers!(i8 u16 i16 u32 i32 u64 i64 f32 f64);

impl Number for u8 {
    const SIZE: usize = 1;
    fn get(bytes: &[u8], _big: bool) -> Self {
        bytes[0]
    }
    fn put(self, bytes: &mut [u8]) {
        bytes[0] = self;
    }
    fn list(bytes: &[u8], _big: bool) -> Vec<Self> {
        bytes.to_vec()
    }
    fn append(values: &[Self], out: &mut Vec<u8>) {
        out.extend_from_slice(values);
    }
}

impl Number for bool {
    const SIZE: usize = 1;
    fn get(bytes: &[u8], _big: bool) -> Self {
        bytes[0] != 0
    }
    fn put(self, bytes: &mut [u8]) {
        bytes[0] = self as u8;
    }
}

/// The first multiple of `n` from `p` on.
#[inline]
pub fn align(p: usize, n: usize) -> usize {
    (p + n - 1) & !(n - 1)
}

/// Whether there is a NUL in a text. Most texts are so short that a call of the search takes longer than these loops.
#[inline]
fn has_nul(text: &[u8]) -> bool {
    if text.len() > 64 {
        return text.contains(&0);
    }
    let chunks = text.chunks_exact(8);
    let rest = chunks.remainder().contains(&0);
    rest || chunks.fold(false, |any, chunk| any | chunk.contains(&0))
}

/// Where a string ends that begins at `p`.
#[inline]
pub fn end_of_string(p: usize, s: &str) -> usize {
    align(p, 4) + 5 + s.len()
}

/// Where a wstring ends that begins at `p`.
pub fn end_of_wstring(p: usize, s: &str) -> usize {
    align(p, 4) + 4 + 4 * s.encode_utf16().count()
}

/// Where numbers end that begin at `p`, after their count.
#[inline]
pub fn end_of_numbers<T: Number>(p: usize, values: &[T]) -> usize {
    if values.is_empty() { p } else { align(p, T::SIZE) + T::SIZE * values.len() }
}

/// A payload that is written.
pub struct Writer {
    out: Vec<u8>,
}

impl Writer {
    /// Append zeros up to a multiple of `n`.
    #[inline]
    pub fn align(&mut self, n: usize) {
        let end = align(self.out.len() - 4, n) + 4;
        self.out.resize(end, 0);
    }
    /// Append bytes at a multiple of `n`.
    #[inline]
    pub fn bytes(&mut self, n: usize, bytes: &[u8]) {
        self.align(n);
        self.out.extend_from_slice(bytes);
    }
    /// Append the count of a sequence.
    pub fn count(&mut self, count: usize, most: usize, field: &'static str) -> Result<()> {
        if count > most {
            return Err(Error::Bound { field, most });
        }
        self.bytes(4, &(count as u32).to_le_bytes());
        Ok(())
    }
    /// Append numbers, after their count.
    pub fn numbers<T: Number>(&mut self, values: &[T]) {
        if !values.is_empty() {
            self.align(T::SIZE);
            T::append(values, &mut self.out);
        }
    }
    /// Append a string.
    pub fn string(&mut self, s: &str, most: usize, field: &'static str) -> Result<()> {
        check(s, most, field)?;
        if s.as_bytes().contains(&0) {
            return Err(Error::Nul { field });
        }
        self.bytes(4, &(s.len() as u32 + 1).to_le_bytes());
        self.out.extend_from_slice(s.as_bytes());
        self.out.push(0);
        Ok(())
    }
    /// Append a wstring.
    pub fn wstring(&mut self, s: &str, most: usize, field: &'static str) -> Result<()> {
        check(s, most, field)?;
        self.count(s.encode_utf16().count(), u32::MAX as usize, field)?;
        for unit in s.encode_utf16() {
            self.out.extend_from_slice(&(unit as u32).to_le_bytes());
        }
        Ok(())
    }
}

/// Numbers in a payload, of either byte order.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<'a, T> {
    bytes: &'a [u8],
    big: bool,
    kind: std::marker::PhantomData<T>,
}

impl<'a, T: Number> Numbers<'a, T> {
    /// The number of elements.
    pub fn len(&self) -> usize {
        self.bytes.len() / T::SIZE
    }
    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
    /// One element, or None.
    pub fn get(&self, index: usize) -> Option<T> {
        self.bytes.chunks_exact(T::SIZE).nth(index).map(|chunk| T::get(chunk, self.big))
    }
    /// All elements, one after the other.
    pub fn iter(&self) -> impl Iterator<Item = T> + 'a {
        let big = self.big;
        self.bytes.chunks_exact(T::SIZE).map(move |chunk| T::get(chunk, big))
    }
    /// A copy.
    pub fn to_vec(&self) -> Vec<T> {
        T::list(self.bytes, self.big)
    }
    /// The bytes in the payload.
    pub fn as_bytes(&self) -> &'a [u8] {
        self.bytes
    }
}

/// The text of bytes that are not UTF-8.
#[cold]
fn replaced(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes)
}

/// Refuse a text with too many characters.
#[inline]
fn check(s: &str, most: usize, field: &'static str) -> Result<()> {
    if s.len() > most && s.chars().count() > most { Err(Error::Bound { field, most }) } else { Ok(()) }
}

/// A payload that is read.
pub struct Reader<'a> {
    payload: &'a [u8],
    at: usize,
    /// Whether the payload is big endian.
    pub big: bool,
}

impl<'a> Reader<'a> {
    /// A reader at the first value of a payload.
    pub fn new(payload: &'a [u8]) -> Result<Self> {
        if payload.len() < 4 {
            return Err(Error::End { at: payload.len(), wanted: 4 });
        }
        Ok(Reader { payload, at: 4, big: payload[1] & 1 == 0 })
    }
    /// The next bytes, at a multiple of `n`.
    #[inline]
    pub fn take(&mut self, n: usize, size: usize) -> Result<&'a [u8]> {
        let start = align(self.at - 4, n) + 4;
        let bytes = self.payload.get(start..).and_then(|rest| rest.get(..size));
        let bytes = bytes.ok_or(Error::End { at: start, wanted: size })?;
        self.at = start + size;
        Ok(bytes)
    }
    /// The next bytes of a known number.
    #[inline]
    pub fn run<const N: usize>(&mut self, n: usize) -> Result<&'a [u8; N]> {
        let bytes = self.take(n, N)?;
        bytes.try_into().map_err(|_| Error::End { at: self.at, wanted: N })
    }
    /// The value at an offset of a run.
    #[inline]
    pub fn value<T: Number, const N: usize>(&self, run: &[u8; N], offset: usize) -> T {
        T::get(&run[offset..offset + T::SIZE], self.big)
    }
    /// The array at an offset of a run.
    #[inline]
    pub fn array<T: Number, const C: usize, const N: usize>(&self, run: &[u8; N], offset: usize) -> [T; C] {
        let bytes = &run[offset..offset + C * T::SIZE];
        let mut chunks = bytes.chunks_exact(T::SIZE);
        std::array::from_fn(|_| chunks.next().map_or(T::default(), |chunk| T::get(chunk, self.big)))
    }
    /// The count of a sequence whose elements have at least `size` bytes each.
    pub fn count(&mut self, size: usize, most: usize, field: &'static str) -> Result<usize> {
        let count = u32::get(self.take(4, 4)?, self.big) as usize;
        if count > most {
            return Err(Error::Bound { field, most });
        }
        if count > (self.payload.len() - self.at) / size {
            return Err(Error::End { at: self.at, wanted: count.saturating_mul(size) });
        }
        Ok(count)
    }
    /// A sequence of numbers, where it is in the payload.
    pub fn numbers<T: Number>(&mut self, most: usize, field: &'static str) -> Result<Numbers<'a, T>> {
        let count = self.count(T::SIZE, most, field)?;
        let bytes = self.take(if count > 0 { T::SIZE } else { 1 }, count * T::SIZE)?;
        Ok(Numbers { bytes, big: self.big, kind: std::marker::PhantomData })
    }
    /// The bytes of a string, up to its first NUL.
    #[inline]
    fn text(&mut self) -> Result<&'a [u8]> {
        let size = u32::get(self.take(4, 4)?, self.big) as usize;
        match self.take(1, size)? {
            [text @ .., 0] if !has_nul(text) => Ok(text),
            bytes => Ok(bytes.split(|byte| *byte == 0).next().unwrap_or(bytes)),
        }
    }
    /// A string where it is in the payload. What is not UTF-8 is copied, with U+FFFD in its place.
    // Inlined, so that a result of three words does not go through memory for each string.
    #[inline(always)]
    pub fn str(&mut self, most: usize, field: &'static str) -> Result<Cow<'a, str>> {
        let bytes = self.text()?;
        let s = match std::str::from_utf8(bytes) {
            Ok(s) => Cow::Borrowed(s),
            Err(_) => replaced(bytes),
        };
        check(&s, most, field)?;
        Ok(s)
    }
    /// A string.
    #[inline(always)]
    pub fn string(&mut self, most: usize, field: &'static str) -> Result<String> {
        let bytes = self.text()?;
        let s = match std::str::from_utf8(bytes) {
            Ok(s) => s.to_owned(),
            Err(_) => replaced(bytes).into_owned(),
        };
        check(&s, most, field)?;
        Ok(s)
    }
    /// A wstring.
    pub fn wstring(&mut self, most: usize, field: &'static str) -> Result<String> {
        let count = self.count(4, u32::MAX as usize, field)?;
        let units: Option<Vec<u16>> =
            self.take(4, 4 * count)?.chunks_exact(4).map(|chunk| u32::get(chunk, self.big).try_into().ok()).collect();
        let s = units.and_then(|units| String::from_utf16(&units).ok()).ok_or(Error::Text { at: self.at })?;
        check(&s, most, field)?;
        Ok(s)
    }
    /// What a function reads, as many times as the array has elements.
    pub fn each<T, const C: usize>(&mut self, mut read: impl FnMut(&mut Self) -> Result<T>) -> Result<[T; C]> {
        let mut values = Vec::with_capacity(C);
        for _ in 0..C {
            values.push(read(self)?);
        }
        values.try_into().map_err(|_| Error::End { at: self.at, wanted: C })
    }
}
