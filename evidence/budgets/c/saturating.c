/* 32-bit integers, each operation saturated through 64 bits: the style of generated code with "saturate on integer overflow". */
#include "controller.h"

static inline int32_t saturate(int64_t x)
{
    if (x > INT32_MAX) {
        return INT32_MAX;
    } else if (x < INT32_MIN) {
        return INT32_MIN;
    } else {
        return (int32_t)x;
    }
}

static inline int32_t add(int32_t a, int32_t b) { return saturate((int64_t)a + b); }
static inline int32_t subtract(int32_t a, int32_t b) { return saturate((int64_t)a - b); }
static inline int32_t negate(int32_t a) { return saturate(-(int64_t)a); }
static inline int32_t magnitude(int32_t a) { return a < 0 ? negate(a) : a; }
static inline int32_t multiply(int32_t a, int32_t b) { return saturate(((int64_t)a * b) >> 16); }

static inline int32_t limit(int32_t x, int32_t bound)
{
    if (x > bound) {
        return bound;
    } else if (x < -bound) {
        return -bound;
    } else {
        return x;
    }
}

uint64_t STEP(saturating_step)(const integer_parameters *p, integer_state *s, int32_t reference, int32_t pressure)
{
    int32_t error = subtract(reference, pressure);
    int32_t error_change = subtract(error, s->error);
    int32_t pressure_change = subtract(pressure, s->pressure);
    bool inside = magnitude(error) < p->tolerance;
    if (inside || (error < 0) != (s->error < 0)) {
        s->boost = 0;
    }
    s->error = error;
    s->pressure = pressure;

    int32_t predicted = add(error, add(error_change, error_change));
    if (inside || magnitude(predicted) < p->tolerance) {
        return integer_duties(0, 0);
    }

    int32_t sum = limit(add(s->sum, error), p->sum_max);
    int32_t towards_reference = error < 0 ? negate(pressure_change) : pressure_change;
    int32_t boost = s->boost;
    if (towards_reference < p->boost_response) {
        boost = limit(add(boost, multiply(p->boost_rate, error)), p->boost_max);
    }

    int32_t u = add(multiply(p->gain, error), multiply(p->derivative_gain, error_change));
    u = add(add(u, multiply(p->integral_gain, sum)), boost);
    bool driven = (u > FULL && error >= 0) || (u < -FULL && error < 0);
    u = limit(u, FULL);
    if (!driven) {
        s->sum = sum;
        s->boost = boost;
    }

    if (u > 0) {
        return integer_duties(add(p->duty_min_fill, multiply(u, p->slope_fill)), 0);
    } else if (u < 0) {
        return integer_duties(0, add(p->duty_min_vent, multiply(negate(u), p->slope_vent)));
    } else {
        return integer_duties(0, 0);
    }
}
