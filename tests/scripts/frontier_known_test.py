"""frontier_known: the committed limits are those of the systems in their rows, and a changed row, number or law is reported."""
import importlib.machinery
import importlib.util
import sys
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
LOADER = importlib.machinery.SourceFileLoader("frontier_known", str(ROOT / "scripts" / "frontier_known"))
KNOWN = importlib.util.module_from_spec(importlib.util.spec_from_loader("frontier_known", LOADER))
LOADER.exec_module(KNOWN)
TEXT = KNOWN.TABLE.read_text()


def row(**members):
    return dict(KNOWN.DEFAULTS, name="a row", **members)


class Table(unittest.TestCase):
    def test_every_limit_in_the_table_is_the_computed_one(self):
        rows = KNOWN.rows_of(TEXT)
        self.assertEqual(len(rows), 52)
        for known, limit in rows:
            with self.subTest(known["name"]):
                self.assertEqual(limit, round(KNOWN.limit(known)))
        self.assertEqual(KNOWN.rewritten(TEXT), TEXT)

    def test_a_changed_number_is_restored_and_a_row_that_is_not_read_is_refused(self):
        wrong = TEXT.replace(".stiffness = 10084}", ".stiffness = 10085}", 1)
        self.assertEqual(KNOWN.rewritten(wrong), TEXT)
        with self.assertRaises(KNOWN.Fault):
            KNOWN.rows_of(TEXT.replace(".delay = 1", ".lateness = 1", 1))
        with self.assertRaises(KNOWN.Fault):
            KNOWN.rows_of(TEXT.replace('{.name = "b 2"', '{.title = "b 2"', 1))

    def test_a_row_that_says_another_system_has_another_limit(self):
        for old, new in ((".latency_ticks = 1,", ".latency_ticks = 2,"), (".damping = 2,", ".damping = 1.9,"), (".scheme = linear,", ".scheme = hold,"),
                         (".spring = 300,", ".spring = 600,"), (".coupling_damping = 5,", ".coupling_damping = 6,")):
            with self.subTest(old):
                self.assertNotEqual(KNOWN.rewritten(TEXT.replace(old, new, 1)), TEXT.replace(old, new, 1))


class Limits(unittest.TestCase):
    def test_without_delay_the_limit_is_where_the_roots_product_is_one(self):
        # Two complex roots leave the circle together: det P + K (P_xv G_v - P_vv G_x) = 1.
        for body in ((0.1, 5.0, 0.0), (0.1, 0.5, 0.0), (0.25, 5.0, 300.0)):
            p, g = KNOWN.flow(*body, 1e-3)
            by_hand = (1.0 - (p[0] * p[3] - p[1] * p[2])) / (p[1] * g[1] - p[3] * g[0])
            found = KNOWN.limit(row(mass=body[0], damping=body[1], spring=body[2]))
            self.assertAlmostEqual(found / by_hand, 1.0, delta=1e-8)

    def test_a_damped_free_body_bears_two_dampings_over_the_period(self):
        # Colgate and Schenkel's 2 b/T holds for m -> infinity; at b T/m = 5e-4 the next term of its series is as small.
        self.assertAlmostEqual(KNOWN.limit(row(mass=10.0)) / (2.0 * 5.0 / 1e-3), 1.0, delta=5e-4)

    def test_a_held_period_of_n_ticks_is_a_servo_as_slow(self):
        slow = KNOWN.limit(row(servo_hz=100.0))
        self.assertAlmostEqual(KNOWN.limit(row(contact_ticks=10.0)) / slow, 1.0, delta=1e-8)
        self.assertLess(KNOWN.limit(row(contact_ticks=10.0, latency_ticks=10.0)), 0.5 * slow)

    def test_the_flow_is_that_of_many_small_steps(self):
        # The midpoint rule in n steps is off by (h/n)^2 of h's own change, |A h|^3/(24 n^2) with |A h| < 1: under 1e-9.
        for mass, damping, spring in ((0.1, 5.0, 0.0), (0.15, 4.5, 300.0), (0.7, 10.5, 1000.0)):
            steps, time = 20000, 5e-3
            h = time / steps
            for x, v, force in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
                x0, v0 = x, v
                for _ in range(steps):
                    a = (force - damping * v - spring * x) / mass
                    xm, vm = x + 0.5 * h * v, v + 0.5 * h * a
                    x, v = x + h * vm, v + h * (force - damping * vm - spring * xm) / mass
                p, g = KNOWN.flow(mass, damping, spring, time)
                self.assertAlmostEqual(x, p[0] * x0 + p[1] * v0 + g[0] * force, delta=1e-9)
                self.assertAlmostEqual(v, p[2] * x0 + p[3] * v0 + g[1] * force, delta=1e-8)

    def test_schur_cohn_tells_roots_inside_from_roots_outside(self):
        for roots, inside in (((0.5, -0.9), True), ((0.5, 1.1), False), ((-1.01, 0.2, 0.3), False), ((0.99, -0.99, 0.9), True)):
            polynomial = [1.0]
            for root in roots:
                polynomial = KNOWN.times(polynomial, [-root, 1.0])
            self.assertEqual(KNOWN.stable(polynomial), inside)
        self.assertFalse(KNOWN.stable([1.0, 0.0, 1.0]))


if __name__ == "__main__":
    unittest.main()
