/* The composed filter step of robins, once more in C: the reference for its speed.

   The same algorithm in the same order: update (S and its Cholesky factor, gain, Joseph form), then prediction
   (Jacobian, F P F^T + Q, with only half of a symmetric product computed; or, where UNSCENTED is defined, sigma points,
   their mean and their covariance). The sizes are constants, so the compiler unrolls and vectorises (-O3 -march=native);
   zeros are skipped only where that is faster than vectors.

   MODEL names the header with the system, to be included: it defines the numbers n of errors, s of states, m of
   measurements and l of inputs, the struct Model, and propagate, linearise, observe, linearise_observation, retract. */

#include <math.h>
#include <string.h>

#include MODEL

/* out = A B, skipping zeros of A */
static void multiply(int rows, const double A[][n], const double B[n][n], double out[][n]) {
    for (int i = 0; i < rows; i++) {
        double row[n] = {0};
        for (int k = 0; k < n; k++)
            if (A[i][k] != 0.0)
                for (int j = 0; j < n; j++) row[j] += A[i][k] * B[k][j];
        memcpy(out[i], row, sizeof row);
    }
}

/* out = A T^T + Q, symmetric: T is transposed, so that whole rows are added up, skipping zeros of A */
static void congruence(const double T[n][n], const double A[n][n], const double Q[n][n], double out[n][n]) {
    double turned[n][n];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) turned[j][i] = T[i][j];
    multiply(n, A, turned, out);
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) out[i][j] = out[j][i] = out[i][j] + Q[i][j];
}

/* Lower factor; inlined for each size */
static inline __attribute__((always_inline)) int cholesky(int size, const double S[size][size], double L[size][size]) {
    for (int j = 0; j < size; j++) {
        double pivot = S[j][j];
        for (int k = 0; k < j; k++) pivot -= L[j][k] * L[j][k];
        if (!(pivot > 0.0 && pivot < INFINITY)) return 0;
        L[j][j] = sqrt(pivot);
        for (int i = j + 1; i < size; i++) {
            double total = S[i][j];
            for (int k = 0; k < j; k++) total -= L[i][k] * L[j][k];
            L[i][j] = total / L[j][j];
            L[j][i] = 0.0;
        }
    }
    return 1;
}

/* The fields of robins.kalman.predict.Ukf */
typedef struct {
    double spread, mean_centre, covariance_centre, other;
} SigmaPoints;

#ifdef UNSCENTED
/* out += scale A^T A, whole rows */
static void add_gram(double scale, const double A[n][n], double out[n][n]) {
    for (int i = 0; i < n; i++) {
        double row[n];
        memcpy(row, out[i], sizeof row);
        for (int k = 0; k < n; k++)
            for (int j = 0; j < n; j++) row[j] += scale * A[k][i] * A[k][j];
        memcpy(out[i], row, sizeof row);
    }
}

/* Mean and covariance of sigma points that the model has moved: from sums and differences of each pair's distances from the centre */
static int predict(const Model *model, const SigmaPoints *sigma, double *x, double P[n][n], const double *u) {
    double L[n][n], points[2 * n + 1][n], even[n][n], odd[n][n], shift[n] = {0};
    if (!cholesky(n, P, L)) return 0;
    double scale = sqrt(sigma->spread);
    memcpy(points[0], x, sizeof points[0]);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            points[1 + i][j] = x[j] + scale * L[j][i];
            points[1 + n + i][j] = x[j] - scale * L[j][i];
        }
    for (int i = 0; i <= 2 * n; i++) propagate(model, points[i], u);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            double ahead = points[1 + i][j] - points[0][j], behind = points[1 + n + i][j] - points[0][j];
            even[i][j] = ahead + behind, odd[i][j] = ahead - behind;
            shift[j] += sigma->other * even[i][j];
        }
    double centre = sigma->covariance_centre + 2.0 * n * sigma->other - 2.0;
    process_noise(model, P);
    for (int i = 0; i < n; i++) {
        x[i] = points[0][i] + shift[i];
        for (int j = 0; j < n; j++) P[i][j] += centre * shift[i] * shift[j];
    }
    add_gram(0.5 * sigma->other, even, P);
    add_gram(0.5 * sigma->other, odd, P);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++) P[j][i] = P[i][j];
    return 1;
}
#else
static int predict(const Model *model, const SigmaPoints *none, double *x, double P[n][n], const double *u) {
    double F[n][n], Q[n][n], FP[n][n];
    linearise(model, x, u, F, Q);
    propagate(model, x, u);
    multiply(n, F, P, FP);
    congruence(FP, F, Q, P);
    return 1;
}
#endif

/* Posterior covariance (I - K H) P (I - K H)^T + K R K^T = T + (K R - T H^T) K^T, T = P - K (H P), in place; K transposed */
static void joseph(double P[n][n], const double K[m][n], const double HP[m][n], const double H[m][n], const double R[m][m]) {
    double T[n][n], W[m][n];
    for (int i = 0; i < n; i++) {
        double row[n];
        memcpy(row, P[i], sizeof row);
        for (int a = 0; a < m; a++)
            for (int j = 0; j < n; j++) row[j] -= K[a][i] * HP[a][j];
        memcpy(T[i], row, sizeof row);
    }
    for (int a = 0; a < m; a++) {
        double row[n] = {0};
        for (int b = 0; b < m; b++)
            for (int i = 0; i < n; i++) row[i] += R[a][b] * K[b][i];
        for (int k = 0; k < n; k++)
            if (H[a][k] != 0.0)
                for (int i = 0; i < n; i++) row[i] -= T[i][k] * H[a][k];
        memcpy(W[a], row, sizeof row);
    }
    for (int i = 0; i < n; i++) {
        double row[n];
        memcpy(row, T[i], sizeof row);
        for (int a = 0; a < m; a++)
            for (int j = 0; j < n; j++) row[j] += W[a][i] * K[a][j];
        memcpy(T[i], row, sizeof row);
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) P[i][j] = P[j][i] = T[i][j];
}

/* Update P and find the error of the state; returns the normalised innovation squared, NaN when S is not positive definite */
static double update(double P[n][n], const double *innovation, const double H[m][n], const double R[m][m], const double *weights,
                     double *error) {
    double weighted[m][m], HP[m][n], K[m][n], S[m][m], L[m][m], white[m], nis = 0.0;
    memcpy(weighted, R, sizeof weighted);
    for (int i = 0; i < m; i++) weighted[i][i] = R[i][i] / weights[i];
    multiply(m, H, P, HP);
    for (int a = 0; a < m; a++)
        for (int b = 0; b <= a; b++) {
            double total = weighted[a][b];
            for (int k = 0; k < n; k++)
                if (H[b][k] != 0.0) total += HP[a][k] * H[b][k];
            S[a][b] = S[b][a] = total;
        }
    if (!cholesky(m, S, L)) return NAN;
    memcpy(K, HP, sizeof K);
    for (int i = 0; i < m; i++) { /* K becomes S^-1 H P, the gain transposed */
        for (int k = 0; k < i; k++)
            for (int r = 0; r < n; r++) K[i][r] -= L[i][k] * K[k][r];
        double inverse = 1.0 / L[i][i];
        for (int r = 0; r < n; r++) K[i][r] *= inverse;
    }
    for (int i = m - 1; i >= 0; i--) {
        for (int k = i + 1; k < m; k++)
            for (int r = 0; r < n; r++) K[i][r] -= L[k][i] * K[k][r];
        double inverse = 1.0 / L[i][i];
        for (int r = 0; r < n; r++) K[i][r] *= inverse;
    }
    for (int i = 0; i < m; i++) {
        double total = innovation[i];
        for (int k = 0; k < i; k++) total -= L[i][k] * white[k];
        white[i] = total / L[i][i];
        nis += white[i] * white[i];
    }
    memset(error, 0, n * sizeof *error);
    for (int a = 0; a < m; a++)
        for (int i = 0; i < n; i++) error[i] += K[a][i] * innovation[a];
    joseph(P, K, HP, H, weighted);
    return nis;
}

/* Filter `epochs` measurements; leaves each posterior state, its covariance and its NIS. Returns 0, or 1 + the epoch that failed. */
long run_filter(const Model *model, const SigmaPoints *sigma, const double R[m][m], const double *x0, const double *P0,
                const double *controls, const double *measurements, long epochs, double *states, double *covariances, double *nis) {
    double x[s], P[n][n], H[m][n], predicted[m], weights[m], innovation[m], error[n];
    memcpy(x, x0, sizeof x);
    memcpy(P, P0, sizeof P);
    for (long k = 0; k < epochs; k++) {
        const double *u = controls + l * k;
        linearise_observation(model, x, u, H);
        observe(model, x, u, predicted);
        for (int i = 0; i < m; i++) {
            innovation[i] = measurements[m * k + i] - predicted[i];
            weights[i] = 1.0;
        }
        nis[k] = update(P, innovation, H, R, weights, error);
        if (isnan(nis[k])) return 1 + k;
        retract(model, x, error);
        memcpy(states + s * k, x, sizeof x);
        memcpy(covariances + n * n * k, P, sizeof P);
        if (k + 1 < epochs && !predict(model, sigma, x, P, u)) return 1 + k;
    }
    return 0;
}
