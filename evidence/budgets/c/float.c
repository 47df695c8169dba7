/* Single precision on the processor's floating-point unit. */
#include "controller.h"

static inline float limit(float x, float bound)
{
    return x > bound ? bound : x < -bound ? -bound : x;
}

float_duties STEP(float_step)(const float_parameters *p, float_state *s, float reference, float pressure)
{
    const float_duties off = {0.0f, 0.0f};
    float error = reference - pressure;
    float error_change = error - s->error;
    float pressure_change = pressure - s->pressure;
    bool inside = __builtin_fabsf(error) < p->tolerance;
    if (inside || (error < 0.0f) != (s->error < 0.0f)) {
        s->boost = 0.0f;
    }
    s->error = error;
    s->pressure = pressure;

    float predicted = error + 2.0f * error_change;
    if (inside || __builtin_fabsf(predicted) < p->tolerance) {
        return off;
    }

    float sum = limit(s->sum + error, p->sum_max);
    float boost = s->boost;
    if ((error < 0.0f ? -pressure_change : pressure_change) < p->boost_response) {
        boost = limit(boost + p->boost_rate * error, p->boost_max);
    }

    float unsaturated = p->gain * error + p->derivative_gain * error_change + p->integral_gain * sum + boost;
    float u = limit(unsaturated, 100.0f);
    if (unsaturated == u || (unsaturated < 0.0f) != (error < 0.0f)) {
        s->sum = sum;
        s->boost = boost;
    }

    if (u > 0.0f) {
        return (float_duties){p->duty_min_fill + u * p->slope_fill, 0.0f};
    } else if (u < 0.0f) {
        return (float_duties){0.0f, p->duty_min_vent - u * p->slope_vent};
    } else {
        return off;
    }
}
