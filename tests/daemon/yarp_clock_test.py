"""/clock, by which YARP programs follow simulated time; its requests; subscriptions at the name server."""
import struct
import unittest

from harness import Connection, Daemon, scenario, until
from yarp_ports import ACK, Reader, registration


class YarpClockTest(unittest.TestCase):
    def talk(self, daemon, address):
        connection = daemon.keep(Connection(address))
        connection.write("CONNACK admin\r\n")
        self.assertEqual(connection.read_line(), "Welcome admin")
        return connection

    def ask(self, connection, request, command="d"):
        connection.write(f"{command}\r\n{request}\r\n")
        answer = connection.read_line()
        self.assertEqual(connection.read_line(), "<ACK>")
        return answer

    def subscribe(self, daemon, reader, source="/clock"):
        """Subscribes like YARP's clock: the name server makes the source connect."""
        names = self.talk(daemon, daemon.names)
        self.assertEqual(self.ask(names, f'subscribe "tcp:/{source}" "tcp:/{reader.name}"'), "[ok]")
        return names

    def accept(self, reader):
        reader.answer_probe()
        connection = reader.accept()
        connection.read_hello()
        return connection

    def time(self, seconds, nanoseconds):
        return struct.pack("<iiii", 257, 2, seconds, nanoseconds)

    def test_who_subscribes_to_the_clock_gets_the_time_at_once_and_each_step(self):
        with Daemon(scenario(1)) as daemon:
            reader = Reader(daemon, "/host/app/4711/clock:i")
            self.subscribe(daemon, reader)
            connection = self.accept(reader)
            self.assertEqual(connection.hello[1], "/clock")
            self.assertEqual(connection.read_sample(ACK)[1], self.time(0, 0))
            motors = daemon.text("/robot1/motors")
            for step in range(1, 4):
                motors.must("set_velocity 0.2 0")
                while (sample := connection.read_sample(ACK)[1]) == self.time(0, 10_000_000 * (step - 1)):
                    pass  # the same once more, as time stood still
                self.assertEqual(sample, self.time(0, 10_000_000 * step))

    def test_while_time_stands_the_clock_repeats_it(self):
        with Daemon(scenario(1)) as daemon:
            reader = Reader(daemon)
            self.subscribe(daemon, reader)
            connection = self.accept(reader)
            for _ in range(4):
                self.assertEqual(connection.read_sample(ACK)[1], self.time(0, 0))

    def test_a_subscription_holds_until_it_is_ended(self):
        with Daemon(scenario(1)) as daemon:
            reader = Reader(daemon)
            names = self.subscribe(daemon, reader)
            self.accept(reader).close()
            self.assertEqual(self.ask(names, "subscribe"), 'subscriptions (subscription (src "/clock") (dest "/reader"))')
            announcement = daemon.keep(Connection(daemon.names))
            announcement.write("NAME_SERVER announce /reader\n")
            self.assertEqual(announcement.read_line(), "[ok]")
            connection = self.accept(reader)
            connection.read_sample(ACK)
            self.assertEqual(self.ask(names, 'unsubscribe "tcp://clock" "tcp://reader"'), "[ok]")
            connection.read_to_end()
            self.assertEqual(self.ask(names, "subscribe"), "subscriptions")

    def test_a_subscription_waits_for_a_reader_that_is_not_there_yet(self):
        with Daemon(scenario(1)) as daemon:
            names = self.talk(daemon, daemon.names)
            self.assertEqual(self.ask(names, 'subscribe "/robot1/pose/state:o" "/reader"'), "[ok]")
            reader = Reader(daemon)
            announcement = daemon.keep(Connection(daemon.names))
            announcement.write("NAME_SERVER announce /reader\n")
            self.assertTrue(reader.first_sample()[0].startswith("D 0 "))

    def test_the_clock_takes_the_calls_of_gazebos(self):
        with Daemon(scenario(1, mode="realtime")) as daemon:
            clock = self.talk(daemon, registration(daemon, "/clock/rpc"))
            self.assertEqual(self.ask(clock, "getStepSize"), "0.01")
            self.assertEqual(self.ask(clock, "pauseSimulation"), "[done]")
            before = float(self.ask(clock, "getSimulationTime"))
            self.assertEqual(float(self.ask(clock, "getSimulationTime")), before)
            self.assertEqual(self.ask(clock, "stepSimulationAndWait 5"), "")
            self.assertAlmostEqual(float(self.ask(clock, "getSimulationTime")), before + 0.05)
            self.assertEqual(self.ask(clock, "stepSimulation"), "[done]")
            self.assertAlmostEqual(float(self.ask(clock, "getSimulationTime")), before + 0.06)
            self.assertEqual(self.ask(clock, "resetSimulation"), "")
            self.assertEqual(float(self.ask(clock, "getSimulationTime")), 0)
            self.assertEqual(self.ask(clock, "continueSimulation"), "[done]")
            until(lambda: float(self.ask(clock, "getSimulationTime")) > 0)
            self.assertRegex(self.ask(clock, "stepSimulation many"), "^.fail. .*as in stepSimulation 10")
            self.assertRegex(self.ask(clock, "explode"), "^.fail. .*there is no such call: pauseSimulation, ")

    def test_a_refused_call_fails_in_words(self):
        with Daemon(scenario(1, mode="realtime"), "--read-only") as daemon:
            clock = self.talk(daemon, registration(daemon, "/clock/rpc"))
            for call in ("pauseSimulation", "continueSimulation", "stepSimulation 3", "stepSimulationAndWait", "resetSimulation",
                         "resetSimulationTime", "resetSimulationState"):
                self.assertRegex(self.ask(clock, call), "^.fail. .*--read-only", call)
            self.assertEqual(self.ask(clock, "getStepSize"), "0.01")

    def test_the_name_server_answers_as_a_port(self):
        with Daemon(scenario(1)) as daemon:
            names = self.talk(daemon, daemon.names)
            self.assertTrue(self.ask(names, "query /robot1/motors").startswith("registration name /robot1/motors ip 127.0.0.1 "))
            self.assertEqual(self.ask(names, "query /nobody"), "")
            self.assertEqual(self.ask(names, "[ver]", "a"), "[ver] 1 2 3")
            names.write("D\r\nregister /mine tcp 127.0.0.1 17001\r\n")
            self.assertEqual(names.read_line(), "<ACK>")
            self.assertEqual(registration(daemon, "/mine"), ("127.0.0.1", 17001))
            names.write("q\r\n")
            self.assertEqual(names.read_line(), "<ACK>")
            self.assertEqual(names.read_to_end(), b"")


if __name__ == "__main__":
    unittest.main()
