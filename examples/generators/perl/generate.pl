#!/usr/bin/perl
# A generator for ifgen, in a language that ifgen does not come with: Perl modules that read and write CDR.
use strict;
use warnings;
use JSON::PP;

my $json = JSON::PP->new->utf8->canonical;    # sorted, so that two runs write the same
my $request = $json->decode(do { local $/; <STDIN> });
if ($request->{request} eq 'describe') {
    print $json->encode({
        name => 'perl', version => '0.1', model => '1.0',
        description => 'Perl modules that read and write CDR',
        options => [{ name => 'root', type => 'string', default => 'ROS', help => 'where package names begin' }],
    });
    exit;
}

my $root = $request->{options}{root};
my @types = @{ $request->{model}{types} };    # with those that others need: their codecs are called
my @files = map { { path => "$root/$_->{type_name}.pm", text => module($_) } } @types;
push @files, { path => "$root/All.pm", text => all() }, { path => 'ROS/Cdr.pm', text => do { local $/; <DATA> } };
print $json->encode({ files => \@files });

# The steps of a codec are data for the interpreter in ROS/Cdr.pm: those members of them that it knows.
sub step {
    my ($step) = @_;
    my %own;
    for (qw(kind path align items steps wide text_maximum primitive count maximum size element_size),
        qw(element_align type_name offset placeholder)) {
        next if !exists $step->{$_};
        $own{$_} = /^(items|steps)$/ ? [map { step($_) } @{ $step->{$_} }] : $step->{$_};
    }
    return \%own;
}

sub literal {
    my ($value) = @_;
    return 'undef' if !defined $value;
    return '[' . join(', ', map { literal($_) } @$value) . ']' if ref $value eq 'ARRAY';
    return '{' . join(', ', map { literal($_) . ' => ' . literal($value->{$_}) } sort keys %$value) . '}'
        if ref $value eq 'HASH';
    return $value ? 1 : 0 if ref $value;    # true and false
    (my $text = "$value") =~ s/([\\'])/\\$1/g;
    return "'$text'";
}

sub default_of {
    my ($field) = @_;
    my ($type, $default, $elements) = @$field{qw(type default_value default_elements)};
    return literal($default->{value}) if $default;
    return literal([map { $_->{value} } @$elements]) if $elements;
    my $zero = $type->{message} ? "ROS::Cdr::create('$type->{message}{type_name}')"
        : $type->{primitive} =~ /string/ ? "''" : '0';
    return $zero if !$type->{array};
    return $type->{array}{kind} eq 'fixed' ? "[map { $zero } 1 .. $type->{array}{size}]" : '[]';
}

sub field {
    my ($field) = @_;
    my $type = $field->{type};
    return {
        name => $field->{name}, primitive => $type->{primitive},
        many => $type->{array} && $type->{array}{kind}, message => $type->{message} && $type->{message}{type_name},
    };
}

sub module {
    my ($type) = @_;
    my ($name, $wire, @fields) = ($type->{type_name}, $type->{wire}, @{ $type->{fields} });
    my $package = join '::', $root, split m{/}, $name;
    my $constants = join '', map { "sub $_->{name} { " . literal($_->{exact_value}{value}) . " }\n" }
        @{ $type->{constants} };
    my $values = join ', ', map { "'$_->{name}' => " . default_of($_) } @fields;
    my ($shown, $steps, $own) = map { literal($_) } [map { field($_) } @fields],
        [map { step($_) } @{ $wire->{steps} }], [map { step($_) } @{ $wire->{own} }];
    return <<"END";
# $name: generated, do not edit.
package $package;
use strict;
use warnings;
use utf8;
use ROS::Cdr;

${constants}sub new { ROS::Cdr::create('$name') }
sub encode { ROS::Cdr::encode('$name', \$_[1]) }
sub decode { ROS::Cdr::decode('$name', \$_[1]) }

\$ROS::Cdr::types{'$name'} = {
    hash => '$type->{type_hash}',
    create => sub { { $values } },
    fields => $shown,
    steps => $steps,
    own => $own,
};
1;
END
}

sub all {
    my %hashes;
    for my $interface (map { @{ $_->{interfaces} } } @{ $request->{model}{packages} }) {
        $hashes{ $_->{type_name} } = $_->{type_hash} for $interface, @{ $interface->{services} };
    }
    my $modules = join '', map { 'require ' . join('::', $root, split m{/}, $_->{type_name}) . ";\n" } @types;
    return "# All modules.\nuse strict;\nuse warnings;\nuse ROS::Cdr;\n$modules\%ROS::Cdr::hashes = \%{"
        . literal(\%hashes) . "};\n1;\n";
}
__DATA__
# Reads and writes CDR, as the steps of docs/model.md say.
package ROS::Cdr;
use strict;
use warnings;
use Encode ();

our (%types, %hashes);
my %codes = (
    bool => 'C', byte => 'C', char => 'C', int8 => 'c', uint8 => 'C', int16 => 's', uint16 => 'S', int32 => 'l',
    uint32 => 'L', int64 => 'q', uint64 => 'Q', float32 => 'f', float64 => 'd',
);

sub code {
    my ($primitive, $order) = @_;
    return $codes{$primitive} . ($codes{$primitive} =~ /c/i ? '*' : "$order*");
}

sub create { $types{ $_[0] }{create}->() }

sub at {
    my ($message, @path) = @_;
    $message = $message->{$_} for @path;
    return $message;
}

sub check {
    my ($step, $count) = @_;
    die "@{$step->{path}}: expected $step->{count} elements, got $count\n"
        if defined $step->{count} && $count != $step->{count};
    die "@{$step->{path}}: expected at most $step->{maximum} elements, got $count\n"
        if defined $step->{maximum} && $count > $step->{maximum};
}

sub check_text {
    my ($step, $text) = @_;
    die "@{$step->{path}}: expected at most $step->{text_maximum} characters\n"
        if defined $step->{text_maximum} && length $text > $step->{text_maximum};
}

sub encode {
    my ($type, $message) = @_;
    my $bytes = '';
    write_steps(\$bytes, $types{$type}{steps}, $message);
    return "\0\1\0\0$bytes";
}

sub pad { my ($bytes, $align) = @_; $$bytes .= "\0" x (-length($$bytes) % $align) }

sub write_text {
    my ($bytes, $step, $text) = @_;
    check_text($step, $text);
    if ($step->{wide}) {
        my @units = unpack 'S<*', Encode::encode('UTF-16LE', $text);
        $$bytes .= pack 'L<*', scalar @units, @units;
    } else {
        my $data = Encode::encode('UTF-8', $text) . "\0";
        $$bytes .= pack('L<', length $data) . $data;
    }
}

sub write_steps {
    my ($bytes, $steps, $message) = @_;
    for my $step (@$steps) {
        my ($kind, $value) = ($step->{kind}, at($message, @{ $step->{path} }));
        pad($bytes, $step->{align});
        if ($kind eq 'run') {
            my $start = length $$bytes;
            for my $item (@{ $step->{items} }) {
                $$bytes .= "\0" x ($start + $item->{offset} - length $$bytes);
                my $of = $item->{placeholder} ? 0 : at($message, @{ $item->{path} });
                my @values = defined $item->{count} ? @$of : $of;
                check($item, scalar @values);
                $$bytes .= pack code($item->{primitive}, '<'), @values;
            }
        } elsif ($kind eq 'text') {
            write_text($bytes, $step, $value);
        } elsif ($kind eq 'call') {
            write_steps($bytes, $types{ $step->{type_name} }{own}, $value);
        } else {
            check($step, scalar @$value);
            $$bytes .= pack 'L<', scalar @$value if !defined $step->{count};
            pad($bytes, $step->{element_align} // 1) if @$value;
            $$bytes .= pack code($step->{primitive}, '<'), @$value if $kind eq 'values';
            for my $element ($kind eq 'values' ? () : @$value) {
                if ($kind eq 'texts') { pad($bytes, 4); write_text($bytes, $step, $element) }
                else { write_steps($bytes, $step->{steps}, $element) }
            }
        }
    }
}

sub decode {
    my ($type, $payload) = @_;
    my ($first, $second) = unpack 'CC', $payload;
    die "expected a header of 4 bytes\n" if length $payload < 4;
    die "expected CDR\n" if $first != 0 || $second > 1;
    my $reader = { data => substr($payload, 4), at => 0, order => $second ? '<' : '>' };
    my $message = create($type);
    read_steps($reader, $types{$type}{steps}, $message);
    return $message;
}

sub take {
    my ($reader, $size) = @_;
    die "the payload ends early\n" if $size > length($reader->{data}) - $reader->{at};
    $reader->{at} += $size;
    return substr $reader->{data}, $reader->{at} - $size, $size;
}

sub align { my ($reader, $align) = @_; take($reader, -$reader->{at} % $align) }

sub read_text {
    my ($reader, $step) = @_;
    my $count = unpack "L$reader->{order}", take($reader, 4);
    my $text;
    if ($step->{wide}) {
        my @units = unpack "L$reader->{order}*", take($reader, 4 * $count);
        $text = Encode::decode('UTF-16LE', pack 'S<*', map { $_ & 0xffff } @units);
    } else {
        my $data = take($reader, $count);
        die "@{$step->{path}}: expected one NUL, at the end\n" if $data !~ /\A[^\0]*\0\z/;
        $text = Encode::decode('UTF-8', substr($data, 0, -1), Encode::FB_CROAK);
    }
    check_text($step, $text);
    return $text;
}

sub values_of {
    my ($reader, $primitive, $data) = @_;
    my @values = unpack code($primitive, $reader->{order}), $data;
    return $primitive eq 'bool' ? map { $_ ? 1 : 0 } @values : @values;
}

sub read_steps {
    my ($reader, $steps, $message) = @_;
    for my $step (@$steps) {
        my ($kind, @path) = ($step->{kind}, @{ $step->{path} });
        my $last = pop @path;
        align($reader, $step->{align});
        if ($kind eq 'run') {
            my $data = take($reader, $step->{size});
            for my $item (grep { !$_->{placeholder} } @{ $step->{items} }) {
                my @names = @{ $item->{path} };
                my $name = pop @names;
                my $part = substr $data, $item->{offset}, $item->{size} * ($item->{count} // 1);
                my @values = values_of($reader, $item->{primitive}, $part);
                at($message, @names)->{$name} = defined $item->{count} ? \@values : $values[0];
            }
        } elsif ($kind eq 'text') {
            at($message, @path)->{$last} = read_text($reader, $step);
        } elsif ($kind eq 'call') {
            read_steps($reader, $types{ $step->{type_name} }{own}, at($message, @{ $step->{path} }));
        } else {
            my $count = $step->{count} // unpack "L$reader->{order}", take($reader, 4);
            check($step, $count);
            align($reader, $step->{element_align} // 1) if $count;
            my @elements;
            if ($kind eq 'values') {
                my $data = take($reader, $count * $step->{element_size});
                @elements = values_of($reader, $step->{primitive}, $data);
            }
            while ($kind ne 'values' && @elements < $count) {    # each takes a byte at least, or the payload ends
                if ($kind eq 'texts') {
                    align($reader, 4);
                    push @elements, read_text($reader, $step);
                } else {
                    push @elements, create($step->{type_name});
                    read_steps($reader, $step->{steps}, $elements[-1]);
                }
            }
            at($message, @path)->{$last} = \@elements;
        }
    }
}
1;
