/* 32-bit integers, tuned by hand: the saturating instructions of the Cortex-M4 and one wide accumulator. */
#include "controller.h"
#include <arm_acle.h>

static inline int32_t limit(int32_t x, int32_t bound)
{
    return x > bound ? bound : x < -bound ? -bound : x;
}

static inline int32_t multiply(int32_t a, int32_t b) { return (int32_t)(((int64_t)a * b) >> 16); }

uint64_t STEP(tuned_step)(const integer_parameters *p, integer_state *s, int32_t reference, int32_t pressure)
{
    /* +-16 bar: then no product below leaves 64 bits and no sum 32. */
    reference = __ssat(reference, 21);
    pressure = __ssat(pressure, 21);
    int32_t error = reference - pressure;
    int32_t error_change = error - s->error;
    int32_t pressure_change = pressure - s->pressure;
    bool inside = (error < 0 ? -error : error) < p->tolerance;
    if (inside || (error ^ s->error) < 0) {
        s->boost = 0;
    }
    s->error = error;
    s->pressure = pressure;

    int32_t predicted = error + 2 * error_change;
    if (inside || (predicted < 0 ? -predicted : predicted) < p->tolerance) {
        return integer_duties(0, 0);
    }

    int32_t sum = limit(__qadd(s->sum, error), p->sum_max);
    int32_t boost = s->boost;
    if ((error < 0 ? -pressure_change : pressure_change) < p->boost_response) {
        boost = limit(__qadd(boost, multiply(p->boost_rate, error)), p->boost_max);
    }

    int64_t wide = (int64_t)p->gain * error + (int64_t)p->derivative_gain * error_change;
    wide += (int64_t)p->integral_gain * sum + ((int64_t)boost << 16);
    /* 2^-12 %, so that a word holds what gains up to 1000 make of it. */
    int32_t unsaturated = (int32_t)(wide >> 20);
    int32_t u = limit(unsaturated, 100 << 12);
    if (unsaturated == u || (unsaturated ^ error) < 0) {
        s->sum = sum;
        s->boost = boost;
    }

    if (u > 0) {
        return integer_duties(p->duty_min_fill + (int32_t)(((int64_t)u * p->slope_fill) >> 12), 0);
    } else if (u < 0) {
        return integer_duties(0, p->duty_min_vent + (int32_t)(((int64_t)-u * p->slope_vent) >> 12));
    } else {
        return integer_duties(0, 0);
    }
}
