/* The composed filter step of robins, once more in C: the reference for its speed.

   The same algorithm in the same order: update (S and its Cholesky factor, gain, Joseph form), then prediction
   (Jacobian, F P F^T + Q), with only half of a symmetric product computed. The sizes are constants, so the compiler
   unrolls and vectorises (-O3 -march=native); zeros are skipped only where that is faster than vectors. */

#include <math.h>
#include <string.h>

enum { n = 9, m = 6, l = 3 };
enum { N, E, U, VE, VN, VU, AZIMUTH, BIAS, SCALE };

typedef struct {
    double dt, bias_decay, scale_decay, noise[n];
} Vehicle;

static void propagate(const Vehicle *v, double *x, const double *u) {
    x[N] += v->dt * x[VN];
    x[E] += v->dt * x[VE];
    x[U] += v->dt * x[VU];
    double speed = (1.0 + x[SCALE]) * u[0], level = speed * cos(u[2]);
    x[VE] = level * sin(x[AZIMUTH]);
    x[VN] = level * cos(x[AZIMUTH]);
    x[VU] = speed * sin(u[2]);
    x[AZIMUTH] += v->dt * (u[1] - x[BIAS]);
    x[BIAS] *= v->bias_decay;
    x[SCALE] *= v->scale_decay;
}

static void linearise(const Vehicle *v, const double *x, const double *u, double F[n][n], double Q[n][n]) {
    memset(F, 0, sizeof(double) * n * n);
    memset(Q, 0, sizeof(double) * n * n);
    for (int i = 0; i < n; i++) Q[i][i] = v->noise[i];
    F[N][N] = F[E][E] = F[U][U] = F[AZIMUTH][AZIMUTH] = 1.0;
    F[N][VN] = F[E][VE] = F[U][VU] = v->dt;
    double sine = sin(x[AZIMUTH]), cosine = cos(x[AZIMUTH]);
    double per_scale = u[0] * cos(u[2]), level = (1.0 + x[SCALE]) * per_scale;
    F[VE][AZIMUTH] = level * cosine, F[VE][SCALE] = per_scale * sine;
    F[VN][AZIMUTH] = -level * sine, F[VN][SCALE] = per_scale * cosine;
    F[VU][SCALE] = u[0] * sin(u[2]);
    F[AZIMUTH][BIAS] = -v->dt;
    F[BIAS][BIAS] = v->bias_decay, F[SCALE][SCALE] = v->scale_decay;
}

/* out = A B, skipping zeros of A */
static void multiply(const double A[n][n], const double B[n][n], double out[n][n]) {
    for (int i = 0; i < n; i++) {
        double row[n] = {0};
        for (int k = 0; k < n; k++)
            if (A[i][k] != 0.0)
                for (int j = 0; j < n; j++) row[j] += A[i][k] * B[k][j];
        memcpy(out[i], row, sizeof row);
    }
}

/* out = T A^T, symmetric: upper half, then mirrored */
static void congruence(const double T[n][n], const double A[n][n], double out[n][n]) {
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++) {
            double total = 0.0;
            for (int k = 0; k < n; k++) total += T[i][k] * A[j][k];
            out[i][j] = out[j][i] = total;
        }
}

static void predict(const Vehicle *v, double *x, double P[n][n], const double *u) {
    double F[n][n], Q[n][n], FP[n][n];
    linearise(v, x, u, F, Q);
    propagate(v, x, u);
    multiply(F, P, FP);
    congruence(FP, F, P);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) P[i][j] += Q[i][j];
}

static int cholesky(const double S[m][m], double L[m][m]) {
    for (int j = 0; j < m; j++) {
        double pivot = S[j][j];
        for (int k = 0; k < j; k++) pivot -= L[j][k] * L[j][k];
        if (!(pivot > 0.0 && pivot < INFINITY)) return 0;
        L[j][j] = sqrt(pivot);
        for (int i = j + 1; i < m; i++) {
            double total = S[i][j];
            for (int k = 0; k < j; k++) total -= L[i][k] * L[j][k];
            L[i][j] = total / L[j][j];
            L[j][i] = 0.0;
        }
    }
    return 1;
}

/* Posterior covariance (I - K H) P (I - K H)^T + K R K^T in place */
static void joseph(double P[n][n], const double K[n][m], const double H[m][n], const double R[m][m]) {
    double A[n][n], AP[n][n], KR[n][m];
    for (int i = 0; i < n; i++) {
        double row[n] = {0};
        row[i] = 1.0;
        for (int k = 0; k < m; k++)
            for (int j = 0; j < n; j++) row[j] -= K[i][k] * H[k][j];
        memcpy(A[i], row, sizeof row);
    }
    multiply(A, P, AP);
    congruence(AP, A, P);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++) {
            double total = 0.0;
            for (int k = 0; k < m; k++) total += K[i][k] * R[k][j];
            KR[i][j] = total;
        }
    for (int i = 0; i < n; i++)
        for (int j = i; j < n; j++) {
            double total = P[i][j];
            for (int k = 0; k < m; k++) total += KR[i][k] * K[j][k];
            P[i][j] = P[j][i] = total;
        }
}

/* Update x and P; returns the normalised innovation squared, NaN when S is not positive definite */
static double update(double *x, double P[n][n], const double *innovation, const double H[m][n], const double R[m][m],
                     const double *weights) {
    double weighted[m][m], PH[n][m], S[m][m], L[m][m], white[m], nis = 0.0;
    memcpy(weighted, R, sizeof weighted);
    for (int i = 0; i < m; i++) weighted[i][i] = R[i][i] / weights[i];
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++) {
            double total = 0.0;
            for (int k = 0; k < n; k++) total += P[i][k] * H[j][k];
            PH[i][j] = total;
        }
    for (int a = 0; a < m; a++)
        for (int b = a; b < m; b++) {
            double total = weighted[a][b];
            for (int k = 0; k < n; k++) total += H[a][k] * PH[k][b];
            S[a][b] = S[b][a] = total;
        }
    if (!cholesky(S, L)) return NAN;
    for (int r = 0; r < n; r++) { /* PH becomes the gain K = PH S^-1 */
        for (int i = 0; i < m; i++) {
            double total = PH[r][i];
            for (int k = 0; k < i; k++) total -= L[i][k] * PH[r][k];
            PH[r][i] = total / L[i][i];
        }
        for (int i = m - 1; i >= 0; i--) {
            double total = PH[r][i];
            for (int k = i + 1; k < m; k++) total -= L[k][i] * PH[r][k];
            PH[r][i] = total / L[i][i];
        }
    }
    for (int i = 0; i < m; i++) {
        double total = innovation[i];
        for (int k = 0; k < i; k++) total -= L[i][k] * white[k];
        white[i] = total / L[i][i];
        nis += white[i] * white[i];
    }
    for (int i = 0; i < n; i++)
        for (int k = 0; k < m; k++) x[i] += PH[i][k] * innovation[k];
    joseph(P, PH, H, weighted);
    return nis;
}

/* Filter `epochs` measurements; leaves each posterior state, its covariance and its NIS. Returns 0, or 1 + the epoch that failed. */
long run_filter(const Vehicle *v, const double H[m][n], const double R[m][m], const double *x0, const double *P0,
                const double *controls, const double *measurements, long epochs,
                double *states, double *covariances, double *nis) {
    double x[n], P[n][n], weights[m], innovation[m];
    memcpy(x, x0, sizeof x);
    memcpy(P, P0, sizeof P);
    for (long k = 0; k < epochs; k++) {
        for (int i = 0; i < m; i++) {
            double predicted = 0.0;
            for (int j = 0; j < n; j++) predicted += H[i][j] * x[j];
            innovation[i] = measurements[m * k + i] - predicted;
            weights[i] = 1.0;
        }
        nis[k] = update(x, P, innovation, H, R, weights);
        if (isnan(nis[k])) return 1 + k;
        memcpy(states + n * k, x, sizeof x);
        memcpy(covariances + n * n * k, P, sizeof P);
        if (k + 1 < epochs) predict(v, x, P, controls + l * k);
    }
    return 0;
}
