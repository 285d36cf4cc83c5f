# SPDX-License-Identifier: MIT
import json
import struct
import unittest

import harness  # noqa: F401  (finds coopdyn.py)
import coopdyn

VECTORS = harness.ROOT / "tests" / "protocol" / "vectors"


def vectors(name):
    return json.loads((VECTORS / f"{name}.json").read_text(encoding="utf-8"))


class CodecTest(unittest.TestCase):
    def test_every_vector_is_encoded_to_its_bytes(self):
        for v in vectors("messages"):
            with self.subTest(v["name"]):
                data = [float(d) for d in v["data"]]
                self.assertEqual(coopdyn.encode(v["command"], v["params"], data, v["text"], v["error"]).hex(), v["binary_hex"])

    def test_every_vector_is_decoded_to_its_values(self):
        for v in vectors("messages"):
            with self.subTest(v["name"]):
                raw = bytes.fromhex(v["binary_hex"])
                message, used = coopdyn.decode(raw + b"next")
                self.assertEqual(used, len(raw))
                self.assertEqual((message.error, message.text, message.command, message.params),
                                 (v["error"], v["text"], v["command"], v["params"]))
                self.assertEqual([struct.pack("<d", d) for d in message.data], [struct.pack("<d", float(d)) for d in v["data"]])

    def test_a_cut_message_needs_more_bytes_wherever_it_is_cut(self):
        raw = coopdyn.encode(11, [1, 2], [0.5], "text")
        for cut in range(len(raw)):
            self.assertEqual(coopdyn.decode(raw[:cut]), (None, 0))

    def test_counts_that_do_not_add_up_are_an_error(self):
        for v in vectors("bad_binary"):
            raw = bytes.fromhex(v["hex"])
            if v["fatal"] and v["needs"] == 24 and len(raw) >= 24:
                with self.subTest(v["name"]), self.assertRaises(coopdyn.Error) as caught:
                    coopdyn.decode(raw)
                self.assertEqual(caught.exception.code, 7)


if __name__ == "__main__":
    unittest.main()
