/* The full step in C, as a baseline: the same algorithm as the crate `controller` with the thesis' choices, prediction two
   samples ahead, PID, anti-windup by conditional integration, boost, tolerance, Scheme 1 with constant lower limits. */
#pragma once
#include <stdbool.h>
#include <stdint.h>

/* Pressures in bar, duty cycles and parts of u in %, the sum of errors in bar; a rate is per sample. Q16.16 in the integer
   versions. */
typedef struct {
    int32_t tolerance, gain, derivative_gain, integral_gain, sum_max;
    int32_t boost_rate, boost_max, boost_response;
    int32_t duty_min_fill, slope_fill, duty_min_vent, slope_vent;
} integer_parameters;

typedef struct {
    float tolerance, gain, derivative_gain, integral_gain, sum_max;
    float boost_rate, boost_max, boost_response;
    float duty_min_fill, slope_fill, duty_min_vent, slope_vent;
} float_parameters;

typedef struct {
    int32_t pressure, error, sum, boost;
} integer_state;

typedef struct {
    float pressure, error, sum, boost;
} float_state;

/* The duty cycles, as each version's calling convention returns them in registers. */
typedef struct {
    float fill, vent;
} float_duties;

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
#define STEP(name) JOIN(name, OPTIMISATION)

#define FULL (100 * 65536)

/* Fill in the lower, vent in the upper word: two registers. */
static inline uint64_t integer_duties(int32_t fill, int32_t vent)
{
    return (uint32_t)fill | (uint64_t)(uint32_t)vent << 32;
}
