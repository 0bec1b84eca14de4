# SPDX-License-Identifier: BSD-2-Clause
"""What the instruments share as programs: options from a table, help made of the same table, messages, exit states.

The forms are those of the commands in C (src/cli/cli.c): who reads one knows the other. One description of a command
serves the command line, `--help` and the man page. numpy is not needed here, because a machine without it has help.
"""
from __future__ import annotations

import enum
import math
import os
import re
import signal
import sys
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any, Callable, Optional, Sequence, Union

from .._errors import Error, Status
from . import text

DONE, FAILED, USAGE, INTERRUPTED = 0, 1, 2, 130
SIZE_RULE = "WxH with sides in [1, 32768], as in 640x480"
SCENE_NOTE = ("SCENE is a file, or - for standard input. The files that such a scene names are\n"
              "looked for in the working directory.\n")
SEED_MAX = float((1 << 53) - 1)
_WIDTH, _INDENT, _MAN_WIDTH, _MOST_TEXTS = 80, 26, 76, 64


class Kind(enum.Enum):
    """What an option takes."""

    FLAG = enum.auto()  #: nothing: True where it stands
    TEXT = enum.auto()  #: str, not empty
    LIST = enum.auto()  #: list of str: the option may be repeated
    COUNT = enum.auto()  #: int in [lo, hi], digits alone
    REAL = enum.auto()  #: float in [lo, hi]; in (lo, hi] where `above`
    SHARE = enum.auto()  #: like REAL, or in percent: "5%" is 0.05. A plain number above 1: a warning asks
    SECONDS = enum.auto()  #: like REAL, or with a unit: "10s", "2min", "1.5h"
    NAME = enum.auto()  #: str, one of `names`
    SIZE = enum.auto()  #: (int, int): "640x480"


FLAG, TEXT, LIST, COUNT, REAL = Kind.FLAG, Kind.TEXT, Kind.LIST, Kind.COUNT, Kind.REAL
SHARE, SECONDS, NAME, SIZE = Kind.SHARE, Kind.SECONDS, Kind.NAME, Kind.SIZE


@dataclass(frozen=True)
class Heading:
    """A heading in the help."""

    text: str


@dataclass(frozen=True)
class Option:
    """An option of a command. Its value is an attribute of what the command's body gets, by the option's name.

    Attributes
    ----------
    name : str
        Without "--".
    argument : str or None
        "N", shown in the help; None for a flag.
    help : str
        A phrase; the help wraps it.
    kind : Kind
        What it takes.
    lo, hi : float
        The range.
    above : bool
        lo itself is out of range.
    names : sequence of str
        Of a NAME.
    default : object
        Where it is not given; a LIST begins empty.
    """

    name: str
    argument: Optional[str]
    help: str
    kind: Kind = Kind.TEXT
    lo: float = 0
    hi: float = math.inf
    above: bool = False
    names: Sequence[str] = ()
    default: Any = None


@dataclass(frozen=True)
class Command:
    """An instrument as a program: all that its help says."""

    name: str
    usage: str
    summary: str
    options: Sequence[Union[Option, Heading]]
    min_operands: int
    max_operands: int
    notes: str = ""


class Say:
    """Messages of a run, printed at its end: all mistakes are told, not only the first one."""

    def __init__(self) -> None:
        self.messages: list[tuple[bool, str]] = []

    def warn(self, message: str) -> None:
        """Add a warning; `--quiet` leaves it out."""
        self.messages.append((False, "warning: " + message))

    def error(self, message: str) -> None:
        """Add an error about the command line or the machine. The body then returns an exit state itself."""
        self.messages.append((True, "error: " + message))

    def of_library(self, message: str, is_error: bool) -> None:
        """Add messages of the library, one a line, which begin with a place, "error: " or "warning: "."""
        for line in message.split("\n"):
            self.messages.append((is_error and ": warning: " not in line, line))

    def failed(self) -> bool:
        """Return whether an error was told."""
        return any(is_error for is_error, _ in self.messages)

    def print(self, quiet: bool) -> None:
        """Print the messages to standard error, and forget them."""
        for is_error, message in self.messages:
            if is_error or not quiet:
                has_place = not message.startswith(("error: ", "warning: "))
                sys.stderr.write("%s%s\n" % ("" if has_place else "bis: ", text.clean(message)))
        self.messages = []
        sys.stderr.flush()


# ---- help ----


def _wrapped(words: str, indent: int, column: int) -> str:
    """The words between columns indent and 80. The cursor stands at `column`."""
    out = []
    for word in words.split():
        if column > indent and column + 1 + len(word) > _WIDTH:
            out.append("\n" + " " * indent)
            column = indent
        elif column > indent:
            out.append(" ")
            column += 1
        out.append(word)
        column += len(word)
    return "".join(out) + "\n"


def _term(option: Option) -> str:
    return "--%s %s" % (option.name, option.argument) if option.argument else "--" + option.name


def _entry(term: str, words: str) -> str:
    start = "  " + term
    if len(start) > _INDENT - 2:
        start += "\n" + " " * _INDENT
    return start.ljust(_INDENT) + _wrapped(words, _INDENT, _INDENT)


def help_text(c: Command) -> str:
    """Return the help of a command, at most 80 columns wide.

    Parameters
    ----------
    c : Command
        The command.

    Returns
    -------
    str
        What `--help` prints.
    """
    out = ["usage: bis %s\n" % c.usage, _wrapped(c.summary, 0, 0)]
    for o in c.options:
        out.append("\n%s:\n" % o.text if isinstance(o, Heading) else _entry(_term(o), o.help))
    out.append("\nabout bis:\n" + _entry("-h, --help", "this text"))
    out.append(_entry("-V, --version", "version, accelerators and libraries"))
    return "".join(out) + ("\n" + c.notes if c.notes else "")


_TROFF = str.maketrans({"\\": "\\e", "-": "\\-", "'": "\\(aq", "`": "\\(ga", "^": "\\(ha", "~": "\\(ti"})


def _escaped(words: str) -> str:
    """Words as troff prints them. A full stop that begins them shall not begin a request."""
    return ("\\&" if words.startswith(".") else "") + words.translate(_TROFF)


def _paragraph(words: str) -> str:
    lines, column = [""], 0
    for word in words.split():
        if column > 0 and column + 1 + len(word) > _MAN_WIDTH:
            lines.append("")
            column = 0
        elif column > 0:
            lines[-1] += " "
            column += 1
        lines[-1] += _escaped(word)
        column += len(word)
    return "\n".join(lines) + "\n"


def _man_notes(notes: str) -> str:
    """Notes are wrapped by hand. Lines up to an empty one are a paragraph; what begins with a blank stays a line."""
    out = ".PP\n"
    for part in re.findall(r"^$|^ .*$|(?:^[^ \n].*\n?)+", notes.rstrip("\n"), re.M):
        if not part:
            out += ".PP\n"
        else:
            out += ".nf\n%s\n.fi\n" % _escaped(part) if part.startswith(" ") else _paragraph(part)
    return out


def man_text(c: Command) -> str:
    """Return the part of the man page that tells of a command.

    Parameters
    ----------
    c : Command
        The command.

    Returns
    -------
    str
        In the language of man(7).
    """
    out = [".SS bis %s\n" % _escaped(c.usage), _paragraph(c.summary)]
    for o in c.options:
        if isinstance(o, Heading):
            out.append(".PP\n\\fI%s\\fR\n" % _escaped(o.text))
        else:
            out.append(".TP\n\\fB%s\\fR\n%s" % (_escaped(_term(o)), _paragraph(o.help)))
    return "".join(out) + (_man_notes(c.notes) if c.notes else "")


# ---- values ----

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.A)
_UNITS = {REAL: {"": 1.0}, SHARE: {"": 1.0, "%": 1.0}, SECONDS: {"": 1.0, "s": 1.0, "min": 60.0, "h": 3600.0}}


def _rule(o: Option) -> str:
    """What a value must be: "an integer in [1, 64]"."""
    if o.kind == SIZE:
        return SIZE_RULE
    if o.kind == COUNT:
        if o.hi >= 2.0 ** 64:
            return "an integer >= %s, below 2^64" % text.digits(o.lo)
        return "an integer in [%.0f, %.0f]" % (o.lo, o.hi)
    if math.isinf(o.hi):
        return "a number %s %s" % (">" if o.above else ">=", text.digits(o.lo))
    also = {SECONDS: ", or with a unit: 10s, 2min, 1.5h", SHARE: ", as in 0.05, or 5%"}.get(o.kind, "")
    return "a number %sin %s%s, %s]%s" % ("of seconds " if o.kind == SECONDS else "", "(" if o.above else "[",
                                          text.digits(o.lo), text.digits(o.hi), also)


def _number(o: Option, word: str, say: Say) -> Optional[float]:
    found = _NUMBER.match(word)
    unit = word[found.end():] if found else None
    if found is None or unit not in _UNITS[o.kind]:
        return None
    v = float(found.group())
    # Dividing by 100 and not multiplying by 0.01 makes 5% the double nearest to 0.05.
    v = v / 100 if unit == "%" else v * _UNITS[o.kind][unit]
    if not math.isfinite(v) or v < o.lo or v > o.hi or (o.above and v == o.lo):
        return None
    if o.kind == SHARE and v > 1 and not unit:
        # "--error 5" renders until the error is 500 %. It may be meant, but 5 % is likelier.
        say.warn("--%s %s is %g %%: did you mean --%s %s%%, which is %g? If not, write %g%%"
                 % (o.name, word, 100 * v, o.name, word, v / 100, 100 * v))
    return v


def _count(word: str, lo: float, hi: float) -> Optional[int]:
    if not re.fullmatch("[0-9]+", word):
        return None
    v = int(word)
    return v if int(lo) <= v <= (int(hi) if math.isfinite(hi) else (1 << 64) - 1) else None


def _size(word: str) -> Optional[tuple[int, int]]:
    sides = [_count(side, 1, 32768) for side in word.split("x")]
    if len(sides) != 2 or sides[0] is None or sides[1] is None:
        return None
    return sides[0], sides[1]


def _value(o: Option, word: str, say: Say) -> Any:
    """The value of a text; None, and a message, where it is none."""
    if o.kind in (TEXT, LIST):
        if not word:
            say.error("--%s is empty, wants %s" % (o.name, o.argument))
            return None
        return word
    if o.kind == NAME:
        if word in o.names:
            return word
        near = text.nearest(word, list(o.names))
        hint = ' (did you mean "%s"?)' % near if near else ""
        say.error('--%s: no such thing as "%s"%s; it is one of %s' % (o.name, word, hint, ", ".join(o.names)))
        return None
    if o.kind == COUNT:
        v: Any = _count(word, o.lo, o.hi)
    elif o.kind == SIZE:
        v = _size(word)
    else:
        v = _number(o, word, say)
    if v is None:
        say.error('--%s is "%s", must be %s' % (o.name, word, _rule(o)))
    return v


# ---- the command line ----


@dataclass
class _Reader:
    """A command line under way."""

    command: Command
    say: Say
    values: SimpleNamespace
    operands: list[str] = field(default_factory=list)
    has_unknown: bool = False

    def option(self, arguments: Sequence[str], i: int) -> int:
        """Read the option at i. Returns how many arguments it took."""
        name, equals, value = arguments[i][2:].partition("=")
        options = [o for o in self.command.options if isinstance(o, Option)]
        found = [o for o in options if o.name == name]
        if not found:
            self.unknown(name, [o.name for o in options])
            return 1
        o = found[0]
        self.values.given.add(o.name)
        if o.kind == FLAG and equals:
            self.say.error('--%s takes no value, has "%s"' % (o.name, value))
        elif o.kind == FLAG:
            self.store(o, True)
        elif equals:
            self.store(o, _value(o, value, self.say))
        elif i + 1 == len(arguments) or arguments[i + 1].startswith("--"):
            self.say.error("--%s wants a value: --%s %s" % (o.name, o.name, o.argument))
        else:
            self.store(o, _value(o, arguments[i + 1], self.say))
            return 2
        return 1

    def unknown(self, name: str, names: list[str]) -> None:
        """Tell of an option that the command does not have."""
        self.has_unknown = True
        near = text.nearest(name, ["help", "version"] + names)
        if near:
            self.say.error('unknown option "--%s" (did you mean "--%s"?)' % (name, near))
        else:
            self.say.error('unknown option "--%s"; `bis %s --help` lists them' % (name, self.command.name))

    def store(self, o: Option, value: Any) -> None:
        """Keep a value under the option's name."""
        if value is None:
            return
        if o.kind != LIST:
            setattr(self.values, o.name, value)
            return
        values = getattr(self.values, o.name)
        if len(values) == _MOST_TEXTS:
            self.say.error("--%s stands here more than %d times" % (o.name, _MOST_TEXTS))
        else:
            values.append(value)

    def read(self, arguments: Sequence[str]) -> None:
        """Read all arguments. Options and operands may be mixed; "--" ends the options."""
        i = 0
        options_over = False
        while i < len(arguments):
            a = arguments[i]
            taken = 1
            if options_over or not a.startswith("-") or a == "-":
                self.operands.append(a)
            elif a == "--":
                options_over = True
            elif a.startswith("--"):
                taken = self.option(arguments, i)
            else:
                self.say.error('unknown option "%s"; options start with "--"' % a)
                self.has_unknown = True
            i += taken
        self.count_operands()

    def count_operands(self) -> None:
        """Tell if there are too few or too many. Behind an unknown option its value may be one of too many."""
        c, n = self.command, len(self.operands)
        if n < c.min_operands or (n > c.max_operands and not self.has_unknown):
            many = "too few operands" if n < c.min_operands else "too many operands"
            self.say.error("%s: %d given; usage: bis %s" % (many, n, c.usage))


def _answers(c: Command, arguments: Sequence[str]) -> bool:
    """Whether a question about the command stands there. It is answered then."""
    before = arguments[:list(arguments).index("--")] if "--" in arguments else arguments
    for a in before:
        if a in ("--help", "-h"):
            sys.stdout.write(help_text(c))
        elif a == "--help=man":
            sys.stdout.write(man_text(c))
        elif a in ("--version", "-V"):
            _print_version()
        else:
            continue
        return True
    return False


def _print_version() -> None:
    """Print what the program says of itself: the program knows its libraries."""
    program = os.environ.get("BIS_PROGRAM", "bis")
    sys.stdout.flush()
    os.execvp(program, ["bis", "--version"])


# ---- running ----

_interrupted = False


def interrupted() -> bool:
    """Return whether INT, TERM or HUP came since `catch_signals`."""
    return _interrupted


def catch_signals() -> None:
    """Let the first INT, TERM or HUP set a flag, so that what was measured is written. The second one kills.

    A handler, never KeyboardInterrupt: that could come in the middle of a rename.
    """

    def caught(number: int, frame: Any) -> None:
        global _interrupted
        _interrupted = True
        signal.signal(number, signal.SIG_DFL)

    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, caught)


def exit_status(status: int) -> int:
    """Return the exit state of a status of the library.

    Parameters
    ----------
    status : Status
        Of an `Error`.

    Returns
    -------
    int
        2 for a mistake in the input, 1 for the disk and for memory.
    """
    if status == Status.OK:
        return DONE
    return USAGE if status == Status.INPUT else FAILED


_unwritten: Optional[OSError] = None


def put(words: str) -> None:
    """Write to standard output. `finish` tells if that cannot be written.

    Parameters
    ----------
    words : str
        What is no UTF-8 in them, as in a file's name, is written as it came.
    """
    global _unwritten
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(encoding=sys.getfilesystemencoding(), errors="surrogateescape")
    try:
        sys.stdout.write(words)
        sys.stdout.flush()
    except OSError as e:
        _unwritten = e


def finish(status: int) -> int:
    """Return status after standard output is written; 1, with a message, if it cannot be."""
    try:
        if _unwritten:
            raise _unwritten
        sys.stdout.flush()
    except OSError as e:
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what is left must not fail again at exit
        sys.stderr.write("bis: error: standard output cannot be written: %s\n" % e.strerror)
        return status or FAILED
    return status


def _outcome(body: Callable[[], int], say: Say) -> int:
    """The exit state of a body, with what it raises as messages."""
    try:
        return body()
    except Error as e:
        say.of_library(str(e), True)
        return exit_status(e.status)
    except MemoryError:
        say.error("no memory")
        return FAILED
    except OSError as e:
        name = "" if e.filename is None else '"%s": ' % os.fsdecode(e.filename)
        say.error("%s%s" % (name, e.strerror))
        return FAILED


def run(c: Command, arguments: Sequence[str],
        body: Callable[[SimpleNamespace, list[str], Say], int]) -> int:
    """Take a command from its arguments to its exit state.

    Parameters
    ----------
    c : Command
        What it is.
    arguments : sequence of str
        Behind its name.
    body : callable
        It is given the values of the options, the operands, and where its messages go. It returns the exit state.
        What it raises becomes a message: an `Error` exit state 2 or 1, an OSError or MemoryError 1.

    Returns
    -------
    int
        0 done, 1 could not read or write, or no memory, 2 bad usage or bad scene, 130 interrupted.
    """
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # ends the process, as it ends a program in C
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writing then fails with a message
    if _answers(c, arguments):
        return finish(DONE)
    say = Say()
    values = SimpleNamespace(given=set())
    for o in c.options:
        if isinstance(o, Option):
            default = [] if o.kind == LIST else False if o.kind == FLAG else o.default
            setattr(values, o.name, default)
    reader = _Reader(c, say, values)
    reader.read(arguments)
    failed, quiet = say.failed(), bool(getattr(values, "quiet", False))
    say.print(quiet)
    if failed:
        return USAGE
    status = _outcome(lambda: body(values, reader.operands, say), say)
    say.print(quiet)
    return finish(status)
