#!/usr/bin/perl
# The testee of the conformance suite (docs/conformance.md) for the generated modules: perl -Ilib testee.pl
use strict;
use warnings;
use Encode ();
use ROS::All;

$| = 1;
my %orders = (float32 => "f>", float64 => "d>");
my %operations = (
    hash => sub { ($ROS::Cdr::types{ $_[0] } // {})->{hash} // $ROS::Cdr::hashes{ $_[0] } },
    default => sub { unpack 'H*', ROS::Cdr::encode($_[0], ROS::Cdr::create($_[0])) },
    recode => sub { unpack 'H*', ROS::Cdr::encode($_[0], ROS::Cdr::decode($_[0], bytes($_[1]))) },
    size => sub { length ROS::Cdr::encode($_[0], ROS::Cdr::decode($_[0], bytes($_[1]))) },
    dump => sub { join ' ', leaves($_[0], ROS::Cdr::decode($_[0], bytes($_[1])), '') },
);

sub bytes { pack 'H*', $_[0] eq '-' ? '' : $_[0] }

sub leaf {
    my ($primitive, $value) = @_;
    return unpack 'H*', pack $orders{$primitive}, $value if $orders{$primitive};
    return "$value" if $primitive !~ /string/;
    return unpack 'H*', Encode::encode($primitive eq 'string' ? 'UTF-8' : 'UTF-16BE', $value);
}

sub leaves {
    my ($type, $message, $before) = @_;
    my @found;
    for my $field (@{ $ROS::Cdr::types{$type}{fields} }) {
        my ($path, $value, $many) = ("$before$field->{name}", $message->{ $field->{name} }, $field->{many});
        push @found, "$path#=" . @$value if $many && $many ne 'fixed';
        for my $i ($many ? 0 .. $#$value : -1) {
            my ($at, $of) = $i < 0 ? ($path, $value) : ("${path}[$i]", $value->[$i]);
            push @found, $field->{message} ? leaves($field->{message}, $of, "$at.")
                : "$at=" . leaf($field->{primitive}, $of);
        }
    }
    return @found;
}

while (my $line = <STDIN>) {
    chomp $line;
    my ($operation, $id, $type, @arguments) = split / /, $line;
    if ($operation eq 'hello') {
        print "ok $id protocol=1 language=perl library=example skip=load,constant,equal,bench\n";
    } elsif (!$operations{$operation} || !($ROS::Cdr::types{$type} || $ROS::Cdr::hashes{$type})) {
        print "skip $id unknown\n";
    } else {
        my $data = eval { $operations{$operation}->($type, @arguments) };
        print defined $data ? "ok $id $data\n" : "refused $id " . ($@ =~ s/\s+/ /gr) . "\n";
    }
}
