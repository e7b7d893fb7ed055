/* Elements of real materials in an engine of one's own: three of them under x = 5 mm sin(8 t), a row at every 10 ms.
 *
 *     cargo build --release -p springpot-capi
 *     cc -I crates/springpot-capi/include crates/springpot-capi/examples/bank.c -L target/release -lspringpot_capi -lm -o bank
 *     LD_LIBRARY_PATH=target/release ./bank
 */
#include "springpot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { ELEMENTS = 3, INPUTS = 1, NODES = 3, STEPS = 100 };

static const char *const TEXT =
    "[{ \"name\": \"pad\", \"law\": \"springpot\", \"parameters\": { \"c\": \"50 N*s^alpha/m\", \"alpha\": 0.4 } },"
    " { \"name\": \"mount\", \"network\": \"parallel(spring(k_e), series(spring(k_m), springpot(c, alpha)))\","
    "   \"parameters\": { \"k_e\": \"2 N/mm\", \"k_m\": \"5 N/mm\", \"c\": 300, \"alpha\": 0.6 } },"
    " { \"name\": \"damper\", \"law\": \"magnetorheological\","
    "   \"parameters\": { \"E_c\": 50, \"mu_0\": 50, \"mu\": 200, \"alpha\": 0.8 } }]";

static void done(springpot_status status) {
    if (status != SPRINGPOT_STATUS_OK) {
        fprintf(stderr, "springpot: %s\n", springpot_last_error());
        exit(1);
    }
}

int main(void) {
    const double h = 0.01;
    springpot_bank *bank;
    done(springpot_bank_new(TEXT, SPRINGPOT_NODES_RADAU, SPRINGPOT_FORM_RATES, &bank));

    double nodes[NODES + 1] = {0.0};
    done(springpot_bank_positions(bank, nodes + 1, NODES));
    const double strokes_at_0[ELEMENTS] = {0.0, 0.0, 0.0}, voltage_at_0[INPUTS] = {0.0};
    done(springpot_bank_begin(bank, strokes_at_0, ELEMENTS, voltage_at_0, INPUTS, 1e-11, h, 2.0));

    printf("t,pad,mount,damper\n");
    for (int n = 0; n < STEPS; n++) {
        const double t = n / 100.0;
        double strokes[ELEMENTS][NODES + 1], rates[ELEMENTS][NODES + 1], voltage[INPUTS][NODES + 1];
        double voltage_rate[INPUTS][NODES + 1], forces[ELEMENTS][NODES];
        for (int k = 0; k <= NODES; k++) {
            const double at = t + nodes[k] * h;
            for (int e = 0; e < ELEMENTS; e++) {
                strokes[e][k] = 0.005 * sin(8.0 * at);
                rates[e][k] = 0.04 * cos(8.0 * at);
            }
            voltage[0][k] = 2.0 * at;
            voltage_rate[0][k] = 2.0;
        }
        done(springpot_bank_evaluate(bank, t, h, *strokes, *rates, ELEMENTS * (NODES + 1), *voltage, *voltage_rate,
                                     INPUTS * (NODES + 1), *forces, ELEMENTS * NODES, NULL, NULL, 0));
        done(springpot_bank_commit(bank));
        printf("%.17g,%.17g,%.17g,%.17g\n", (n + 1) / 100.0, forces[0][NODES - 1], forces[1][NODES - 1],
               forces[2][NODES - 1]);
    }
    for (size_t e = 0; e < springpot_bank_elements(bank); e++) {
        double energies[3];
        done(springpot_bank_energies(bank, e, energies));
        fprintf(stderr, "%s: %g J stored, %g J dissipated, %g J supplied\n", springpot_bank_name(bank, e), energies[0],
                energies[1], energies[2]);
    }
    springpot_bank_free(bank);
    return 0;
}
