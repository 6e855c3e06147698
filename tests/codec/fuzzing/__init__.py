"""A fuzzer of the codecs: mutated bytes and mutated messages, about which all codecs must agree.

    .venv/bin/python -m tests.codec.fuzzing --cases 1000000 --jobs 2

It compares the codec in C (where `ifgen_native` runs), the generated functions and the slow codec: same bytes,
same objects down to types and bits, same errors in the same words. A case is a number: the same seed and number
make the same case, so `--only NUMBER` runs one alone.
"""
