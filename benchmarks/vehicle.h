/* The system of benchmarks.models. */

enum { n = 9, s = 9, m = 6, l = 3 };
enum { N, E, U, VE, VN, VU, AZIMUTH, BIAS, SCALE };

typedef struct {
    double dt, bias_decay, scale_decay, noise[n], H[m][n];
} Model;

static void propagate(const Model *v, double *x, const double *u) {
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

static void process_noise(const Model *v, double Q[n][n]) {
    memset(Q, 0, sizeof(double) * n * n);
    for (int i = 0; i < n; i++) Q[i][i] = v->noise[i];
}

static void linearise(const Model *v, const double *x, const double *u, double F[n][n], double Q[n][n]) {
    memset(F, 0, sizeof(double) * n * n);
    process_noise(v, Q);
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

static void observe(const Model *v, const double *x, const double *u, double *z) {
    for (int i = 0; i < m; i++) {
        z[i] = 0.0;
        for (int j = 0; j < n; j++) z[i] += v->H[i][j] * x[j];
    }
}

static void linearise_observation(const Model *v, const double *x, const double *u, double H[m][n]) {
    memcpy(H, v->H, sizeof v->H);
}

static void retract(const Model *v, double *x, const double *error) {
    for (int i = 0; i < n; i++) x[i] += error[i];
}
