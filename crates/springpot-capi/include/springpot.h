/* Springpot: elements of real materials for other engines.
 *
 * A bank holds elements: laws from stroke x(t) (and inputs: temperature, voltage) to force, which may remember the whole past motion, such as the springpot
 * F = c D^alpha x. It knows no robot and chooses no step. A step from t to t + h is evaluated as often as an implicit method likes, and committed once:
 *
 *     springpot_bank *bank;
 *     springpot_bank_new(text, SPRINGPOT_NODES_ONE, SPRINGPOT_FORM_RATES, &bank);
 *     springpot_bank_begin(bank, strokes, n, inputs, m, 1e-9, h, horizon);
 *     for (...) {
 *         springpot_bank_evaluate(bank, t, h, strokes, rates, n * (s + 1), inputs, NULL, m * (s + 1), forces, n * s, NULL, NULL, 0);
 *         springpot_bank_commit(bank);
 *     }
 *     springpot_bank_free(bank);
 *
 * SI units; forces are positive in tension; arrays are row-major. Functions that return a springpot_status write nothing but what they say, whatever it is; the words
 * of an error are springpot_last_error(). No function aborts or throws. One thread at a time may use a bank, different threads may use different banks.
 * Memory of a bank is its own, that of arrays the caller's; pointers are not kept.
 *
 * Made by cbindgen of src/c.rs and src/status.rs: change those.
 */

#ifndef SPRINGPOT_H
#define SPRINGPOT_H

#include <stddef.h>
#include <stdint.h>

/*
 How a call ended. What was wrong is told by `springpot_last_error`.
 */
typedef enum {
  /*
   Done.
   */
  SPRINGPOT_STATUS_OK = 0,
  /*
   A pointer is NULL or not aligned, an array has another length than is wanted, a number is no element.
   */
  SPRINGPOT_STATUS_ARGUMENT = 1,
  /*
   The text of the elements is refused: syntax, units, names, ranges.
   */
  SPRINGPOT_STATUS_TEXT = 2,
  /*
   A call out of order: no `springpot_bank_begin` before, no `springpot_bank_evaluate` before a commit, a step that does not start where the last one ended.
   */
  SPRINGPOT_STATUS_ORDER = 3,
  /*
   A number is NaN or infinite, or a step is not longer than 0.
   */
  SPRINGPOT_STATUS_NUMBER = 4,
  /*
   An input is missing, outside its range, or breaks a rule of its law.
   */
  SPRINGPOT_STATUS_INPUT = 5,
  /*
   No memory can be built for these steps, or no force fits these strokes.
   */
  SPRINGPOT_STATUS_UNSOLVED = 6,
  /*
   The bytes are no state of a bank of the same elements.
   */
  SPRINGPOT_STATUS_STATE = 7,
  /*
   A defect of the library; the bank is as it was or has to be begun anew.
   */
  SPRINGPOT_STATUS_DEFECT = 8,
} springpot_status;

/*
 Where a step of size h from t on is asked: at the nodes t + c_i h, i = 1 ... s.
 */
typedef enum {
  /*
   s = 1, c = (1): steps of one size, as in real time or in engines with a fixed step.
   */
  SPRINGPOT_NODES_ONE = 1,
  /*
   s = 3, c = ((4 - sqrt 6)/10, (4 + sqrt 6)/10, 1): Radau IIA, order five in forward dynamics.
   */
  SPRINGPOT_NODES_RADAU = 3,
} springpot_nodes;

/*
 What the fractional derivatives take x' for over a step.
 */
typedef enum {
  /*
   The polynomial through the rates at the start and at the nodes: order 5 - alpha along a known motion with SPRINGPOT_NODES_RADAU.
   */
  SPRINGPOT_FORM_RATES = 0,
  /*
   The derivative of the polynomial through the strokes: order 4 - alpha with SPRINGPOT_NODES_RADAU, 2 - alpha (the L1 scheme) with SPRINGPOT_NODES_ONE;
   stable however stiff the element is.
   */
  SPRINGPOT_FORM_STROKES = 1,
} springpot_form;

/*
 What the strokes of a step are. It matters after a Riemann-Liouville start with x(0) != 0 alone, whose force is singular at t = 0.
 */
typedef enum {
  /*
   Those of a motion that is known: forces are those at the nodes.
   */
  SPRINGPOT_COURSE_GIVEN = 0,
  /*
   Sought, so that equations of motion hold: the singular part enters by its moments over the step, and impulses are exact.
   */
  SPRINGPOT_COURSE_SOUGHT = 1,
} springpot_course;

/*
 Elements with their laws, states and energies. One thread at a time may use a bank; different banks may be used by different threads.
 */
typedef struct springpot_bank springpot_bank;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 The version of the library, such as "0.1.0".
 */
const char *springpot_version(void);

/*
 What was wrong with the last call of this thread that did not return SPRINGPOT_STATUS_OK, in words (UTF-8); valid until its next such call.
 */
const char *springpot_last_error(void);

/*
 Makes a bank of the elements of a text.

 The text (UTF-8) is JSON, `[{ "law": "springpot", "parameters": { "c": "50 N*s^alpha/m", "alpha": 0.4 }, "derivative": "caputo" }, ...]`, or `[[element]]`
 tables of a scenario (TOML), with the keys name, law or network, parameters, inputs, derivative or past, shift, thermal, expansion, as docs/SCENARIO.md has
 them: numbers are SI, quantities have units. Inputs that the text leaves out are told by the caller. The force is F(x) as `springpot laws NAME` says it,
 positive in tension, for the stroke x, length less rest length; on an angle m reads rad and N reads N*m.

 `nodes` is a springpot_nodes, `form` a springpot_form. `*bank` is the new bank, to be freed by springpot_bank_free; NULL after an error.

 Errors: ARGUMENT, TEXT.

 # Safety
 `text` is NULL or ends with a NUL; `bank` is NULL or can be written to.
 */
springpot_status springpot_bank_new(const char *text,
                                    uint32_t nodes,
                                    uint32_t form,
                                    springpot_bank **bank);

/*
 Frees a bank; NULL is nothing.

 # Safety
 `bank` is NULL or of springpot_bank_new, and no longer used.
 */
void springpot_bank_free(springpot_bank *bank);

/*
 Number of elements n; 0 of NULL.

 # Safety
 `bank` is NULL or of springpot_bank_new.
 */
size_t springpot_bank_elements(const springpot_bank *bank);

/*
 Number of inputs of all elements m; 0 of NULL.

 # Safety
 `bank` is NULL or of springpot_bank_new.
 */
size_t springpot_bank_inputs(const springpot_bank *bank);

/*
 Name of element `element`, 0 ... n - 1, valid as long as the bank; NULL where there is none.

 # Safety
 `bank` is NULL or of springpot_bank_new.
 */
const char *springpot_bank_name(const springpot_bank *bank, size_t element);

/*
 Name of input `input`, 0 ... m - 1, as ELEMENT.INPUT, valid as long as the bank; NULL where there is none. Inputs stand in the order of the elements, each in
 the order of its law.

 # Safety
 `bank` is NULL or of springpot_bank_new.
 */
const char *springpot_bank_input_name(const springpot_bank *bank,
                                      size_t input);

/*
 Writes the nodes c_1 ... c_s of a step into `positions`, which has room for `length` = s numbers.

 Errors: ARGUMENT.

 # Safety
 `bank` is NULL or of springpot_bank_new; `positions` is NULL or has room for `length` numbers.
 */
springpot_status springpot_bank_positions(const springpot_bank *bank, double *positions, size_t length);

/*
 Says what the strokes of the steps to come are, a springpot_course; at first SPRINGPOT_COURSE_GIVEN.

 Errors: ARGUMENT.

 # Safety
 `bank` is NULL or of springpot_bank_new.
 */
springpot_status springpot_bank_set_course(springpot_bank *bank, uint32_t course);

/*
 Goes to t = 0; whatever was is forgotten.

 `strokes`: x(0), m, shape (n). A Riemann-Liouville element with x(0) != 0 has jumped there: write 0 where it is rounding alone. `inputs`: at t = 0, SI, shape (m);
 NULL with `inputs_length` = 0: what the text says. `tolerance`: relative error of the memories, 1e-13 ... 0.1, such as 1e-9. `shortest`: the shortest step that is
 planned, s; shorter ones may follow all the same. `horizon`: the longest past that is remembered to the tolerance, s.

 Errors: ARGUMENT, NUMBER, INPUT, UNSOLVED.

 # Safety
 `bank` is NULL or of springpot_bank_new; arrays are NULL or as long as is said.
 */
springpot_status springpot_bank_begin(springpot_bank *bank,
                                      const double *strokes,
                                      size_t strokes_length,
                                      const double *inputs,
                                      size_t inputs_length,
                                      double tolerance,
                                      double shortest,
                                      double horizon);

/*
 Forces and tangents of a step of size `h` > 0 from `t` on, where the last committed one ended, s. May be called any number of times, with other strokes and other
 sizes; nothing is remembered before springpot_bank_commit.

 `points` = n (s + 1) numbers each: `strokes` x, m, and `rates` x', m/s, shape (n, s + 1), the start of the step first, then its nodes.
 `input_points` = m (s + 1): `inputs`, SI, shape (m, s + 1); NULL: what the text says at those times; `input_rates`, their time derivatives, which energies take;
 NULL: 0.
 `nodes` = n s: `forces` F_i, N, positive in tension, shape (n, s), are written.
 `tangents` = n s s: `by_stroke` dF_i/dx_j, N/m, and `by_rate` dF_i/dx'_j, N s/m, shape (n, s, s), are written where they are not NULL. Of linear laws
 F_i = sum_j dF_i/dx_j (x_j - x_0) + sum_j dF_i/dx'_j x'_j + H_i, where H_i is known at the start of the step.

 Errors: ARGUMENT, ORDER, NUMBER, INPUT, UNSOLVED.

 # Safety
 `bank` is NULL or of springpot_bank_new; arrays are NULL or as long as is said, those that are written overlap with none.
 */
springpot_status springpot_bank_evaluate(springpot_bank *bank,
                                         double t,
                                         double h,
                                         const double *strokes,
                                         const double *rates,
                                         size_t points,
                                         const double *inputs,
                                         const double *input_rates,
                                         size_t input_points,
                                         double *forces,
                                         size_t nodes,
                                         double *by_stroke,
                                         double *by_rate,
                                         size_t tangents);

/*
 Takes the step that was evaluated last into the past; the next one starts where it ended.

 Errors: ARGUMENT, ORDER.

 # Safety
 `bank` is NULL or of springpot_bank_new.
 */
springpot_status springpot_bank_commit(springpot_bank *bank);

/*
 Writes the energies of element `element` after the last commit into `energies`, 3 numbers, J: stored, and since t = 0 dissipated and supplied by inputs; NaN
 where unknown, as after a Riemann-Liouville start with x(0) != 0. d(stored) = F dx - d(dissipated) + d(supplied).

 Errors: ARGUMENT.

 # Safety
 `bank` is NULL or of springpot_bank_new; `energies` is NULL or has room for 3 numbers.
 */
springpot_status springpot_bank_energies(const springpot_bank *bank,
                                         size_t element,
                                         double *energies);

/*
 Writes what it takes to go on from the last commit, to the bit, into `bytes`, and how many bytes these are into `*needed`. With `length` below that, or `bytes`
 NULL, nothing but `*needed` is written.

 Errors: ARGUMENT (too few bytes, unless `bytes` is NULL), ORDER.

 # Safety
 `bank` is NULL or of springpot_bank_new; `bytes` is NULL or has room for `length` bytes; `needed` is NULL or can be written to.
 */
springpot_status springpot_bank_save(const springpot_bank *bank,
                                     uint8_t *bytes,
                                     size_t length,
                                     size_t *needed);

/*
 Goes on from what springpot_bank_save wrote of a bank of the same text, nodes and form, which has begun, later or earlier; nothing changes after an error.

 Errors: ARGUMENT, ORDER, STATE.

 # Safety
 `bank` is NULL or of springpot_bank_new; `bytes` is NULL or holds `length` bytes.
 */
springpot_status springpot_bank_load(springpot_bank *bank,
                                     const uint8_t *bytes,
                                     size_t length);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* SPRINGPOT_H */
