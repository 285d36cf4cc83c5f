#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the golden vectors beside this file, and the seeds of the codec fuzzers.

It implements the wire format on its own (struct, repr), so that the vectors check the codecs instead of repeating them.
Usage: python3 tests/protocol/vectors/generate.py          rewrites messages, bad_binary, text_lines, first_bytes and doubles
"""
import json
import pathlib
import re
import struct

HERE = pathlib.Path(__file__).resolve().parent
FUZZ = HERE.parent.parent / "fuzz"
INF, NAN = float("inf"), float("nan")


def frame(error, text, command, params, data):
    raw = text if isinstance(text, bytes) else text.encode()
    body = struct.pack("<iiIII", error, command, len(raw), len(params), len(data)) + raw
    body += struct.pack(f"<{len(params)}i", *params) + struct.pack(f"<{len(data)}d", *data)
    return struct.pack("<I", len(body)) + body


def quoted(text):
    for char, escape in (("\\", "\\\\"), ('"', '\\"'), ("\n", "\\n"), ("\r", "\\r"), ("\t", "\\t")):
        text = text.replace(char, escape)
    return f'"{text}"'


def full_line(error, text, command, params, data):
    fields = [str(error), quoted(text), str(command), str(len(params)), *map(str, params), str(len(data))]
    return " ".join(fields + [repr(float(x)) for x in data])


MESSAGES = [  # name, error, text, command, params, data
    ("ping", 0, "", 0, [], []),
    ("ping with params and data", 0, "", 0, [1, 2, -3], [0.5]),
    ("ready", 0, "", 2, [], []),
    ("ready for ten steps", 0, "", 2, [10], []),
    ("set_velocity", 0, "", 11, [], [0.2, 0.5]),
    ("set_velocity for ten steps", 0, "", 11, [10], [0.2, 0.5]),
    ("set_wheel_speeds", 0, "", 10, [], [-1.5, 2.0]),
    ("reply to set_velocity", 0, "", 11, [1], [0.01, 1.0]),
    ("reply to set_velocity, limited", 0, "limited to 0.4 m/s", 11, [0], [12.34, 1234.0]),
    ("reply with attached readings", 0, "", 11, [1, 3, 2], [0.5, INF, 2.25, 1.5, -0.75, 0.02, 2.0]),
    ("reply to get_distances", 0, "", 20, [], [0.1, 0.2, INF, INF, 0.30000000000000004, 4.0, 1.0, 0.03, 3.0]),
    ("reply to get_targets", 0, "red green", 30, [1, 2], [1.5, 0.1, 2.5, -3.141592653589793, 0.04, 4.0]),
    ("get_target by colour", 0, "red", 31, [], []),
    ("get_target by id", 0, "", 31, [2], []),
    ("pushed pose", 0, "dropped 3", -40, [], [1.0, -2.0, 0.5, 0.0, 0.0, 0.05, 5.0]),
    ("hello with a token", 0, "ana@lab:123 s3cret", 6, [], []),
    ("closing notice", 5, "the scenario was replaced", -1, [], []),
    ("unreadable", 7, "unreadable", -2, [], []),
    ("unknown command", 1, "unknown command 99: describe lists all", 99, [], []),
    ("every escape", 0, 'quote " backslash \\ newline \n return \r tab \t end', 6, [], []),
    ("two byte characters", 0, "größe", 6, [], []),
    ("three byte characters", 0, "距離 €", 6, [], []),
    ("four byte characters", 0, "robot 🤖", 6, [], []),
    ("text of blanks", 0, "  ", 6, [], []),
    ("text like a line", 0, '0 "" 11 0 2 0.2 0.5', 6, [], []),
    ("limits of int32", 0, "", 0, [-2147483648, 2147483647], []),
    ("limits of the command", 0, "", 2147483647, [], []),
    ("lowest command", 0, "", -2147483648, [], []),
    ("infinities", 0, "", 0, [], [INF, -INF]),
    ("not a number", 0, "", 0, [], [NAN]),
    ("zeros", 0, "", 0, [], [0.0, -0.0]),
    ("denormals", 0, "", 0, [], [5e-324, 2.2250738585072014e-308]),
    ("largest double", 0, "", 0, [], [1.7976931348623157e308, -1.7976931348623157e308]),
    ("shortest digits", 0, "", 0, [], [0.1, 1 / 3, 2 / 3, 1e22, 1e23, 123456789.125]),
    ("where the exponent begins", 0, "", 0, [], [0.0001, 0.00009999, 1e15, 9999999999999998.0, 1e16]),
    ("seventeen digits", 0, "", 0, [], [9007199254740993.0, 0.1 + 0.2, 100.00000000000001]),
    ("step_all, a whole team", 0, "", 110, [], [0.2, 0.5, 0.1, 0.0]),
    ("step_all by ids, wheel speeds", 0, "wheels", 110, [3, 1], [2.0, 2.0, -1.5, 1.5]),
    ("reply to step_all", 0, "limited 1 robot", 110, [1, 2, 3], [0.5, -1.0, 0.25, 2.0, 3.0, -0.75, 0.01, 1.0]),
    ("select_readings", 0, "pose neighbours", 111, [4], []),
    ("reply to claim of a team", 0, "ant_1 ant_2", 7, [1, 2], [0.0, 0.0]),
    ("unseen and absent in read_all", 0, "", 112, [1, 1, 5], [INF, NAN, 0.0, INF, NAN, 0.02, 2.0]),
    ("send_message", 0, "", 201, [], [1.0, 0.5]),
    ("reply to get_recording", 0, "lesson1.run", 120, [1], [0.0, 12.5, 1250.0, 0.0, 98304.0, 12.5, 1250.0]),
    ("start of a recording", 0, "lesson1", 121, [], []),
    ("reply to stop of a recording", 0, "lesson1.run http://127.0.0.1:10001/runs/lesson1.run", 122, [], [12.5, 1250.0]),
    ("reply to get_playback", 0, "lesson1.run", 130, [1, 0, 0], [0.0, 60.0, 12.5, -2.0, 12.5, 1250.0]),
    ("seek", 0, "", 131, [], [12.5]),
    ("step back", 0, "", 135, [-10], []),
    ("reply to get_saved", 0, "start before_turn", 196, [], [0.0, 4.5, 12.5, 1250.0]),
    ("reply to get_messages", 0, "", 202, [2, 1, 5, 2], [0.5, 0.1, 7.0, 1.5, -0.2, 1.0, 2.0, 0.03, 3.0]),
    ("many params", 0, "", 0, list(range(100)), []),
    ("many data", 0, "", 0, [], [k / 8 for k in range(100)]),
    ("load_scenario with a file's text", 0, "[WORLD]\nfile = corridor.world\r\n[ROBOT_1]\n\ttype single\n", 108, [], []),
]

GOOD = frame(0, "", 11, [], [0.2, 0.5])


def header(size, error, command, t, m, n):
    return struct.pack("<IiiIII", size, error, command, t, m, n)


BAD_BINARY = [  # name, bytes, error, command, fatal, bytes of it that are enough
    ("size 0", struct.pack("<I", 0), 7, -2, True, 4),
    ("size 19", struct.pack("<I", 19) + bytes(19), 7, -2, True, 4),
    ("size all ones", b"\xff\xff\xff\xff", 8, -2, True, 4),
    ("size over 16 MiB", struct.pack("<I", 16 * 1024 * 1024 + 1), 8, -2, True, 4),
    ("size over 1 MiB", struct.pack("<Iii", 1024 * 1024 + 1, 0, 11), 8, -2, True, 12),
    ("counts smaller than size", header(36, 0, 11, 0, 0, 1) + bytes(16), 7, -2, True, 24),
    ("counts larger than size", header(36, 0, 11, 0, 0, 3) + bytes(16), 7, -2, True, 24),
    ("text beyond the frame", header(20, 0, 6, 1, 0, 0), 7, -2, True, 24),
    ("negative T", header(36, 0, 11, 0xFFFFFFFF, 0, 2) + bytes(16), 7, -2, True, 24),
    ("negative M", header(36, 0, 11, 0, 0xFFFFFFFF, 2) + bytes(16), 7, -2, True, 24),
    ("negative N", header(36, 0, 11, 0, 0, 0xFFFFFFFF) + bytes(16), 7, -2, True, 24),
    ("counts that add up modulo 2^32", header(20, 0, 11, 0, 0x40000000, 0), 7, -2, True, 24),
    ("counts that add up modulo 2^32, data", header(20, 0, 11, 0, 0, 0x20000000), 7, -2, True, 24),
    ("one byte too long", header(21, 0, 2, 0, 0, 0) + b"x", 7, -2, True, 24),
    ("an HTTP request", b"GET / HTTP/1.1\r\n\r\n", 8, -2, True, 4),
    ("a text line", b"set_velocity 0.2 0.5\n", 8, -2, True, 4),
    ("text that is Latin-1", frame(0, b"gr\xfc\xdfe", 6, [], []), 7, 6, False, 29),
    ("text with NUL", frame(0, b"a\0b", 6, [], []), 7, 6, False, 27),
    ("text that ends inside a character", frame(0, b"\xe2\x82", 6, [], []), 7, 6, False, 26),
    ("text with a surrogate", frame(0, b"\xed\xa0\x80", 6, [], []), 7, 6, False, 27),
    ("text with an overlong slash", frame(0, b"\xc0\xaf", 6, [], []), 7, 6, False, 26),
    ("text beyond U+10FFFF", frame(0, b"\xf4\x90\x80\x80", 6, [], []), 7, 6, False, 28),
    ("text with 0xff", frame(0, b"\xff", 31, [], []), 7, 31, False, 25),
]


def ok(command, params=(), data=(), text=""):
    return ("message", 0, command, text, list(params), list(data), "")


def bad(error, command, says):
    return ("bad", error, command, "", [], [], says)


NOTHING = ("nothing", 0, 0, "", [], [], "")
HELP = ("help", 0, 0, "", [], [], "")
LEAVE = ("leave", 0, 0, "", [], [], "")

TEXT_LINES = [  # name, module, first line of its connection, bytes without LF (or with CR), outcome
    ("full form", "motors", False, '0 "" 11 0 2 0.2 0.5', ok(11, [], [0.2, 0.5])),
    ("full form with bare text", "target", False, "0 red 31 0 0", ok(31, text="red")),
    ("full form with blanks and tabs", "motors", False, ' \t0\t ""  11 1 10\t2 .2 5.e-1 ', ok(11, [10], [0.2, 0.5])),
    ("full form with signs", "motors", False, '+0 "" +11 0 2 +0.2 -0.5', ok(11, [], [0.2, -0.5])),
    ("full form with inf and nan in any case", "motors", False, '0 "" 0 0 4 INF -Inf NaN +nan', ok(0, [], [INF, -INF, NAN, NAN])),
    ("full form with escapes", "motors", False, '0 "a \\"b\\" \\\\ \\n\\r\\t" 6 0 0', ok(6, text='a "b" \\ \n\r\t')),
    ("full form, unknown command", "motors", False, '0 "" 99 0 0', ok(99)),
    ("full form, too few data", "motors", False, '0 "" 11 0 2 0.2', bad(7, -2, "data 2 is missing")),
    ("full form, something follows", "motors", False, '0 "" 11 0 2 0.2 0.5 1', bad(7, -2, "nothing may follow")),
    ("full form without text", "motors", False, "0 11 0 2 0.2 0.5", bad(7, -2, "text comes second")),
    ("full form, negative count", "motors", False, '0 "" 11 -1 0', bad(7, -2, "negative")),
    ("full form, huge count", "motors", False, '0 "" 11 2147483647 1', bad(7, -2, "fewer follow")),
    ("full form, param with a point", "motors", False, '0 "" 2 1 10.0 0', bad(7, -2, "write 10")),
    ("full form, other escape", "motors", False, '0 "a\\x" 6 0 0', bad(7, -2, "escapes")),
    ("full form, open quote", "motors", False, '0 "a 6 0 0', bad(7, -2, "closing quote")),
    ("full form, int out of int32", "motors", False, '0 "" 2 1 2147483648 0', bad(7, -2, "too large for a param")),
    ("named", "motors", False, "set_velocity 0.2 0.5", ok(11, [], [0.2, 0.5])),
    ("named with CR", "motors", False, "set_velocity 0.2 0.5\r", ok(11, [], [0.2, 0.5])),
    ("named with blanks", "motors", False, "  set_velocity\t0.2   0.5  ", ok(11, [], [0.2, 0.5])),
    ("named with steps in brackets", "motors", False, "set_velocity (10) 0.2 0.5", ok(11, [10], [0.2, 0.5])),
    ("named with blanks in brackets", "motors", False, "set_velocity ( 10 ) 0.2 0.5", ok(11, [10], [0.2, 0.5])),
    ("named with empty brackets", "motors", False, "set_velocity () 0.2 0.5", ok(11, [], [0.2, 0.5])),
    ("named, whole numbers as data", "motors", False, "set_wheel_speeds 2 -2", ok(10, [], [2.0, -2.0])),
    ("named, exponents", "motors", False, "set_velocity 2e-1 5.E-1", ok(11, [], [0.2, 0.5])),
    ("bare optional param without data", "motors", False, "ready 10", ok(2, [10])),
    ("bracketed param without data", "motors", False, "ready (10)", ok(2, [10])),
    ("optional param left out", "motors", False, "ready", ok(2)),
    ("stop for five steps", "motors", False, "stop 5", ok(14, [5])),
    ("two optional params", "motors", False, "subscribe 10 13", ok(4, [10, 13])),
    ("a reading as a word", "motors", False, "subscribe 10 get_limits", ok(4, [10, 13])),
    ("params and data of ping", "motors", False, "ping (1 2) 0.5", ok(0, [1, 2], [0.5])),
    ("bare values of ping are data", "motors", False, "ping 1 2", ok(0, [], [1.0, 2.0])),
    ("reset with a seed", "simulation", False, "reset 7", ok(104, [7])),
    ("enum word", "simulation", False, "set_mode lockstep", ok(105, [1])),
    ("enum number", "simulation", False, "set_mode 2", ok(105, [2])),
    ("rest of the line", "motors", False, "attach distance pose ", ok(9, text="distance pose")),
    ("rest of the line may be empty", "motors", False, "attach", ok(9)),
    ("hello with a token", "motors", False, "hello ana TOKEN", ok(6, text="ana TOKEN")),
    ("hello in quotes", "motors", False, 'hello "ana TOKEN"', ok(6, text="ana TOKEN")),
    ("load_scenario", "simulation", False, "load_scenario corridor", ok(108, text="corridor")),
    ("load_scenario with a file's text", "simulation", False, 'load_scenario "[WORLD]\\nfile a.world\\n"',
     ok(108, text="[WORLD]\nfile a.world\n")),
    ("release_robot", "simulation", False, "release_robot robot1", ok(193, text="robot1")),
    ("release with a robot", "simulation", False, "release robot1", ok(193, text="robot1")),
    ("release alone", "simulation", False, "release", ok(8)),
    ("text or number: text", "target", False, "get_target red", ok(31, text="red")),
    ("text or number: quoted", "target", False, 'get_target "light blue"', ok(31, text="light blue")),
    ("text or number: UTF-8", "target", False, "get_target grün", ok(31, text="grün")),
    ("text or number: number", "target", False, "get_target 2", ok(31, [2])),
    ("step_all of the team", "swarm", False, "step_all 0.2 0.5 0.1 0", ok(110, [], [0.2, 0.5, 0.1, 0.0])),
    ("step_all by ids", "swarm", False, "step_all (1 2) 0.2 0.5 0.1 0", ok(110, [1, 2], [0.2, 0.5, 0.1, 0.0])),
    ("step_all of wheels", "swarm", False, "step_all (3) wheels 2 2", ok(110, [3], [2.0, 2.0], "wheels")),
    ("step_all that keeps the set-points", "swarm", False, "step_all", ok(110)),
    ("step_all, id 0", "swarm", False, "step_all (0) 0.2 0.5", bad(4, 110, "at least 1")),
    ("claim of names", "swarm", False, "claim swarm1 robot7", ok(7, text="swarm1 robot7")),
    ("claim of all", "swarm", False, "claim", ok(7)),
    ("claim with names on motors", "motors", False, "claim robot1", bad(2, 7, "takes no values")),
    ("select_readings", "swarm", False, "select_readings pose wheels", ok(111, text="pose wheels")),
    ("select_readings with a number in brackets", "swarm", False, "select_readings (4) pose neighbours",
     ok(111, [4], text="pose neighbours")),
    ("select_readings, two numbers", "swarm", False, "select_readings (4 5) pose", bad(2, 111, "in brackets before the text")),
    ("read_all by ids", "swarm", False, "read_all 1 2", ok(112, [1, 2])),
    ("start without a name", "recorder", False, "start", ok(121)),
    ("start of a recording", "recorder", False, "start lesson1", ok(121, text="lesson1")),
    ("a note of several words", "recorder", False, "note the robots meet", ok(123, text="the robots meet")),
    ("a note without text", "recorder", False, "note", bad(2, 123, "note the robots meet")),
    ("the stop of a recording", "recorder", False, "stop", ok(122)),
    ("seek", "playback", False, "seek 12.5", ok(131, [], [12.5])),
    ("seek without a time", "playback", False, "seek", bad(3, 131, "seek 12.5")),
    ("play", "playback", False, "play", ok(132)),
    ("play with a speed", "playback", False, "play -2", ok(132, [], [-2.0])),
    ("one step on", "playback", False, "step", ok(135)),
    ("ten steps back", "playback", False, "step -10", ok(135, [-10])),
    ("set_loop by word", "playback", False, "set_loop on", ok(136, [1])),
    ("set_loop, wrong word", "playback", False, "set_loop maybe", bad(2, 136, "off (0) or on (1)")),
    ("branch at a time", "playback", False, "branch 12.5", ok(137, [], [12.5])),
    ("save", "simulation", False, "save before_turn", ok(194, text="before_turn")),
    ("save without a name", "simulation", False, "save", bad(2, 194, "save before_turn")),
    ("restore", "simulation", False, "restore start", ok(195, text="start")),
    ("send_message", "neighbours", False, "send_message 1 0.5", ok(201, [], [1.0, 0.5])),
    ("send_message without numbers", "neighbours", False, "send_message", bad(3, 201, "send_message 1 0.5")),
    ("send_message, nine numbers", "neighbours", False, "send_message 1 2 3 4 5 6 7 8 9", bad(3, 201, "1 to 8 numbers")),
    ("backspace", "motors", False, "set_velositx\b\b\b\bcity 0.2 0.5", ok(11, [], [0.2, 0.5])),
    ("delete", "motors", False, "stopp\x7f", ok(14)),
    ("backspace takes a whole character", "target", False, "get_target grü\b\x7f\x7fred", ok(31, text="red")),
    ("backspace beyond the start", "motors", False, "\b\bstop", ok(14)),
    ("telnet negotiation", "motors", True, b"\xff\xfb\x18\xff\xfd\x01\xff\xfe\x03\xff\xfc\x22stop\r", ok(14)),
    ("telnet sub-negotiation", "motors", True, b"\xff\xfa\x18\x00xterm\xff\xf0stop\xff\xf1", ok(14)),
    ("empty first line", "motors", True, "", HELP),
    ("empty first line with CR", "motors", True, "\r", HELP),
    ("only negotiation on the first line", "motors", True, b"\xff\xfb\x18\r", HELP),
    ("help", "motors", False, "help", HELP),
    ("verbose", "motors", False, "verbose", ("verbose", 0, 0, "", [], [], "")),
    ("exit", "motors", False, "exit", LEAVE),
    ("quit", "motors", False, " quit \r", LEAVE),
    ("bye", "swarm", True, "bye", LEAVE),
    ("exit of the simulation", "simulation", False, "exit", LEAVE),
    ("quit of the simulation", "simulation", False, "quit", ok(109)),
    ("exit with a value", "motors", False, "exit 1", bad(1, -2, "unknown command 'exit'")),
    ("OPEN a second time", "motors", False, "OPEN /robot1/pose", bad(5, -2, "motors module's already")),
    ("empty line", "motors", False, "", NOTHING),
    ("blank line", "motors", False, " \t ", NOTHING),
    ("comment", "motors", False, "# set_velocity 0.2 0.5", NOTHING),
    ("comment after blanks", "motors", False, "   #", NOTHING),
    ("unknown word", "motors", False, "set_velosity 0.2 0.5", bad(1, -2, "did you mean set_velocity?")),
    ("unknown word in capitals", "motors", False, "STOP", bad(1, -2, "did you mean stop?")),
    ("unknown word far from all", "motors", False, "xyzzyx", bad(1, -2, "help lists all")),
    ("no word", "motors", False, "@stop", bad(7, -2, "starts with a command")),
    ("decimal comma", "motors", False, "set_velocity 0,5 0,1", bad(7, -2, "write 0.5")),
    ("comma between values", "motors", False, "set_velocity 0.2, 0.5", bad(7, -2, "write 0.2")),
    ("comma without blank", "motors", False, "set_velocity 0.2,0.5", bad(7, -2, "0.2 0.5")),
    ("call syntax", "motors", False, "set_velocity(0.2, 0.5)", bad(7, -2, "set_velocity 0.2 0.5")),
    ("unit after a value", "motors", False, "set_velocity 0.2m/s 0.5", bad(7, -2, "write 0.2")),
    ("hexadecimal", "motors", False, "set_velocity 0x10 0.5", bad(7, -2, "not a number")),
    ("infinity in full", "motors", False, "set_velocity infinity 0.5", bad(7, -2, "not a number")),
    ("lone sign", "motors", False, "set_velocity - 0.5", bad(7, -2, "not a number")),
    ("lone point", "motors", False, "set_velocity . 0.5", bad(7, -2, "not a number")),
    ("exponent without digits", "motors", False, "set_velocity 1e 0.5", bad(7, -2, "not a number")),
    ("beyond the largest double", "motors", False, "set_velocity 1e400 0", bad(4, 11, "'1e400' is too large: set_velocity 0.2 0.5")),
    ("below the least double", "motors", False, "set_velocity 0 -1e400", bad(4, 11, "'-1e400' is too large")),
    ("beyond the largest double, full form", "motors", False, '0 "" 11 0 2 1e400 0', bad(7, -2, "too large for a double")),
    ("too few values", "motors", False, "set_velocity 0.2", bad(3, 11, "linear (m/s) and angular (rad/s): set_velocity 0.2 0.5")),
    ("too many values", "motors", False, "set_velocity 0.2 0.5 1", bad(3, 11, "linear (m/s) and angular (rad/s): set_velocity 0.2 0.5")),
    ("too many params", "motors", False, "set_velocity (1 2) 0.2 0.5", bad(2, 11, "steps")),
    ("values where none belong", "pose", False, "get_pose 1", bad(2, 40, "takes no values: get_pose")),
    ("param missing", "simulation", False, "step", bad(2, 103, "step 10")),
    ("param with a point", "motors", False, "ready 1.0", bad(7, -2, "write 1")),
    ("param out of int32", "motors", False, "ready 99999999999", bad(7, -2, "too large for a param")),
    ("param below its least value", "motors", False, "ready 0", bad(4, 2, "1 to 10000000")),
    ("wrong enum word", "simulation", False, "set_mode fast", bad(2, 105, "realtime (0), lockstep (1) or free (2)")),
    ("wrong enum number", "simulation", False, "set_mode 3", bad(4, 105, "realtime (0), lockstep (1) or free (2)")),
    ("text missing", "motors", False, "hello", bad(2, 6, "hello ana")),
    ("text where none belongs", "motors", False, 'set_velocity "fast" 0.2 0.5', bad(2, 11, "takes no text")),
    ("text and number", "target", False, "get_target red 1", bad(2, 31, "either")),
    ("text or number missing", "target", False, "get_target", bad(2, 31, "get_target red")),
    ("not finite", "motors", False, "set_velocity nan 0.5", bad(4, 11, "linear is nan")),
    ("open bracket", "motors", False, "set_velocity (10 0.2 0.5", bad(7, -2, "closing bracket")),
    ("open quote", "motors", False, 'hello "ana', bad(7, -2, "closing quote")),
    ("something after a quote", "motors", False, 'hello "ana" b', bad(7, -2, "nothing may follow")),
    ("other escape", "motors", False, 'hello "\\u0041"', bad(7, -2, "escapes")),
    ("not UTF-8", "motors", False, b"hello gr\xfc\xdfe", bad(7, -2, "not UTF-8")),
    ("NUL", "motors", False, b"hello a\0b", bad(7, -2, "NUL")),
    ("comment after values", "motors", False, "set_velocity 0.2 # slow", bad(7, -2, "line of its own")),
]

FIRST_BYTES = [  # name, bytes, encoding
    ("nothing", b"", "undecided"), ("C", b"C", "undecided"), ("CDS", b"CDS", "undecided"), ("magic", b"CDS1", "binary"),
    ("magic and a frame", b"CDS1" + GOOD, "binary"), ("another version", b"CDS2", "wrong_magic"),
    ("CDS and a line", b"CDS\n", "wrong_magic"), ("a word", b"s", "text"), ("a digit", b"0", "text"),
    ("an empty line", b"\r\n", "text"), ("telnet", b"\xff\xfb", "text"), ("a comment", b"#", "text"),
    ("start of a method", b"GET", "undecided"), ("method and path", b"POST /robot1", "undecided"),
    ("GET", b"GET / HTTP/1.1\r\n", "http"), ("OPTIONS", b"OPTIONS * HTTP/1.1\r\n", "http"),
    ("HTTP before its line ends", b"GET / HTTP/1", "http"), ("CONNECT", b"CONNECT a:1 HTTP/1.1\r\n", "http"),
    ("OPEN", b"OPEN /robot1/motors\n", "text"), ("name server", b"NAME_SERVER list\n", "text"),
    ("capitals", b"STOP\n", "text"), ("a long path", b"GET /" + b"a" * 8200, "http"),
]

DOUBLES = [0.0, -0.0, 1.0, -1.0, 0.1, 1 / 3, 0.01, 123456.0, 1e15, 1e16, 1e22, 1e23, 1e-4, 1e-5, 5e-324, 2.2250738585072014e-308,
           1.7976931348623157e308, INF, -INF, NAN, 3.141592653589793, 9007199254740993.0, 4.35, 299792458.0, 6.02214076e23]


def numbers(values):
    return [repr(float(x)) for x in values]


def write(name, rows):
    lines = ",\n".join(json.dumps(row, ensure_ascii=True) for row in rows)
    (HERE / name).write_text("[\n" + lines + "\n]\n", encoding="ascii")
    print(f"{name}: {len(rows)}")


def seed(folder, name, content):
    path = FUZZ / folder / re.sub(r"[^A-Za-z0-9]+", "_", name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def main():
    write("messages.json", [dict(name=n, error=e, text=t, command=c, params=p, data=numbers(d),
                                 binary_hex=frame(e, t, c, p, d).hex(), text_line=full_line(e, t, c, p, d))
                            for n, e, t, c, p, d in MESSAGES])
    write("bad_binary.json", [dict(name=n, hex=b.hex(), error=e, command=c, fatal=f, needs=k)
                              for n, b, e, c, f, k in BAD_BINARY])
    rows = []
    for name, module, first, line, (outcome, error, command, text, params, data, says) in TEXT_LINES:
        raw = (line if isinstance(line, bytes) else line.encode()) + b"\n"
        rows.append(dict(name=name, module=module, first_line=first, line=raw.decode("latin-1") if isinstance(line, bytes)
                         else line + "\n", line_hex=raw.hex(), outcome=outcome, error=error, command=command, text=text,
                         params=params, data=numbers(data), says=says))
    write("text_lines.json", rows)
    write("first_bytes.json", [dict(name=n, hex=b.hex(), encoding=e) for n, b, e in FIRST_BYTES])
    write("doubles.json", [dict(hex=struct.pack("<d", x).hex(), text=repr(x)) for x in DOUBLES])
    for n, e, t, c, p, d in MESSAGES[::3]:
        seed("codec_binary_corpus", n, frame(e, t, c, p, d))
    for n, b, *_ in BAD_BINARY[::3]:
        seed("codec_binary_corpus", n, b)
    for row in rows[::3]:
        seed("codec_text_corpus", row["name"], bytes.fromhex(row["line_hex"]))


if __name__ == "__main__":
    main()
