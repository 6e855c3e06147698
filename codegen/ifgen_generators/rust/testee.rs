//! Answers requests of `ifgen conformance`, one a line.
#![allow(clippy::all)]

use interfaces::cdr::{Error, Message, Number, Numbers, View};
use std::borrow::Cow;
use std::io::{BufRead, Write};
use std::time::Instant;

type Words<'a> = dyn Iterator<Item = &'a str> + 'a;

enum Answer {
    Ok(String),
    Refused(Error),
    Skip(&'static str),
}

impl From<Result<String, Error>> for Answer {
    fn from(result: Result<String, Error>) -> Self {
        match result {
            Ok(data) => Answer::Ok(data),
            Err(error) => Answer::Refused(error),
        }
    }
}

trait Dump {
    fn dump(&self, path: &str, out: &mut Vec<String>);
}
trait Load {
    fn load(words: &mut Words) -> Self;
}

fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.into() } else { format!("{path}.{name}") }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn bytes(text: &str) -> Vec<u8> {
    let digits = if text == "-" { "" } else { text };
    (0..digits.len() / 2).map(|i| u8::from_str_radix(&digits[2 * i..2 * i + 2], 16).unwrap()).collect()
}

fn text<T: Dump + ?Sized>(value: &T) -> String {
    let mut out = Vec::new();
    value.dump("", &mut out);
    out.concat()[1..].into()
}

fn all<T: Dump>(message: &T) -> String {
    let mut out = Vec::new();
    message.dump("", &mut out);
    out.join(" ")
}

fn next<'a>(words: &mut Words<'a>) -> &'a str {
    words.next().unwrap().split_once('=').unwrap().1
}

macro_rules! integers {
    ($($type:ty)*) => {$(
        impl Dump for $type {
            fn dump(&self, path: &str, out: &mut Vec<String>) { out.push(format!("{path}={self}")); }
        }
        impl Load for $type {
            fn load(words: &mut Words) -> Self { next(words).parse().unwrap() }
        }
    )*};
}
integers!(i8 u8 i16 u16 i32 u32 i64 u64);

macro_rules! floats {
    ($($type:ty, $bits:ty, $digits:literal)*) => {$(
        impl Dump for $type {
            fn dump(&self, path: &str, out: &mut Vec<String>) { out.push(format!(concat!("{}={:0", $digits, "x}"), path, self.to_bits())); }
        }
        impl Load for $type {
            fn load(words: &mut Words) -> Self { Self::from_bits(<$bits>::from_str_radix(next(words), 16).unwrap()) }
        }
    )*};
}
floats!(f32, u32, "8" f64, u64, "16");

impl Dump for bool {
    fn dump(&self, path: &str, out: &mut Vec<String>) { out.push(format!("{path}={}", *self as u8)); }
}
impl Load for bool {
    fn load(words: &mut Words) -> Self { next(words) == "1" }
}
impl Dump for str {
    fn dump(&self, path: &str, out: &mut Vec<String>) { out.push(format!("{path}={}", hex(self.as_bytes()))); }
}
impl Dump for &str {
    fn dump(&self, path: &str, out: &mut Vec<String>) { str::dump(self, path, out); }
}
impl Dump for Cow<'_, str> {
    fn dump(&self, path: &str, out: &mut Vec<String>) { str::dump(self, path, out); }
}
impl Dump for String {
    fn dump(&self, path: &str, out: &mut Vec<String>) { str::dump(self, path, out); }
}
impl Load for String {
    fn load(words: &mut Words) -> Self { String::from_utf8(bytes(next(words))).unwrap() }
}
impl<T: Dump> Dump for [T] {
    fn dump(&self, path: &str, out: &mut Vec<String>) {
        for (i, item) in self.iter().enumerate() { item.dump(&format!("{path}[{i}]"), out); }
    }
}
impl<T: Dump> Dump for Vec<T> {
    fn dump(&self, path: &str, out: &mut Vec<String>) {
        out.push(format!("{path}#={}", self.len()));
        self.as_slice().dump(path, out);
    }
}
impl<T: Dump + Number> Dump for Numbers<'_, T> {
    fn dump(&self, path: &str, out: &mut Vec<String>) { self.to_vec().dump(path, out); }
}
impl<T: Load> Load for Vec<T> {
    fn load(words: &mut Words) -> Self {
        let count: usize = next(words).parse().unwrap();
        (0..count).map(|_| T::load(words)).collect()
    }
}
impl<T: Dump, const N: usize> Dump for [T; N] {
    fn dump(&self, path: &str, out: &mut Vec<String>) { self.as_slice().dump(path, out); }
}
impl<T: Load, const N: usize> Load for [T; N] {
    fn load(words: &mut Words) -> Self { std::array::from_fn(|_| T::load(words)) }
}

fn wide(text: &str) -> String {
    text.encode_utf16().map(|unit| format!("{unit:04x}")).collect()
}

// A wstring has the type of a string, and another text.
struct Wide<T>(T);
trait WideText: Sized {
    fn dump_wide(&self, path: &str, out: &mut Vec<String>);
    fn read_wide(words: &mut Words) -> Self;
}
impl WideText for String {
    fn dump_wide(&self, path: &str, out: &mut Vec<String>) {
        out.push(format!("{path}={}", wide(self)));
    }
    fn read_wide(words: &mut Words) -> Self {
        let units: Vec<u16> = bytes(next(words)).chunks(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect();
        String::from_utf16(&units).unwrap()
    }
}
impl WideText for Vec<String> {
    fn dump_wide(&self, path: &str, out: &mut Vec<String>) {
        out.push(format!("{path}#={}", self.len()));
        for (i, item) in self.iter().enumerate() { WideText::dump_wide(item, &format!("{path}[{i}]"), out); }
    }
    fn read_wide(words: &mut Words) -> Self {
        let count: usize = next(words).parse().unwrap();
        (0..count).map(|_| <String as WideText>::read_wide(words)).collect()
    }
}
impl<const N: usize> WideText for [String; N] {
    fn dump_wide(&self, path: &str, out: &mut Vec<String>) {
        for (i, item) in self.iter().enumerate() { WideText::dump_wide(item, &format!("{path}[{i}]"), out); }
    }
    fn read_wide(words: &mut Words) -> Self { std::array::from_fn(|_| <String as WideText>::read_wide(words)) }
}
impl<T: WideText> Wide<&T> {
    fn dump(&self, path: &str, out: &mut Vec<String>) { self.0.dump_wide(path, out); }
}
fn load_wide<T: WideText>(words: &mut Words) -> T { T::read_wide(words) }

fn of<M: Message + Dump + Load + Default + PartialEq>(
    op: &str, words: &[&str], view: impl Fn(&[u8]) -> Result<String, Error>, constant: impl Fn(&str) -> Option<String>,
) -> Answer {
    let payload = |i: usize| bytes(words[i]);
    let decoded = |i: usize| {
        let data = payload(i);
        let message = M::decode(&data);
        assert_eq!(message.as_ref().map(all), view(&data).as_ref().map(Clone::clone), "the view of a message differs");
        message
    };
    match op {
        "hash" => Answer::Ok(M::TYPE_HASH.into()),
        "default" => M::default().encode().map(|data| hex(&data)).into(),
        "constant" => constant(words[0]).map_or(Answer::Skip("constant"), Answer::Ok),
        "recode" => decoded(0).and_then(|m| m.encode()).map(|data| hex(&data)).into(),
        "size" => decoded(0).map(|m| m.encoded_len().to_string()).into(),
        "equal" => match (decoded(0), decoded(1)) {
            (Ok(one), Ok(other)) => Answer::Ok(((one == other) as u8).to_string()),
            (Err(error), _) | (_, Err(error)) => Answer::Refused(error),
        },
        "dump" => decoded(0).map(|m| all(&m)).into(),
        "load" => {
            let mut leaves = words.iter().copied().filter(|word| !word.is_empty());
            M::load(&mut leaves).encode().map(|data| hex(&data)).into()
        }
        "bench" => bench::<M>(&payload(0), words[1].parse().unwrap()).into(),
        _ => Answer::Skip("unknown-operation"),
    }
}

fn bench<M: Message>(payload: &[u8], count: u32) -> Result<String, Error> {
    let message = M::decode(payload)?;
    let begin = Instant::now();
    for _ in 0..count { std::hint::black_box(std::hint::black_box(&message).encode()?); }
    let encode = begin.elapsed().as_nanos() as f64 / count as f64;
    let begin = Instant::now();
    for _ in 0..count { std::hint::black_box(M::decode(std::hint::black_box(payload))?); }
    let decode = begin.elapsed().as_nanos() as f64 / count as f64;
    Ok(format!("{encode:.1} {decode:.1}"))
}

fn main() {
    let mut output = std::io::stdout();
    for line in std::io::stdin().lock().lines() {
        let line = line.unwrap();
        let words: Vec<&str> = line.split(' ').collect();
        let (op, id, name, rest) = (words[0], words[1], words[2], &words[3..]);
        let answer = match op {
            "hello" => Answer::Ok("protocol=1 language=rust library=ifgen".into()),
            _ => answer(op, name, rest),
        };
        match answer {
            Answer::Ok(data) => writeln!(output, "ok {id} {data}"),
            Answer::Refused(error) => writeln!(output, "refused {id} {error}"),
            Answer::Skip(what) => writeln!(output, "skip {id} {what}"),
        }.unwrap();
        output.flush().unwrap();
    }
}
