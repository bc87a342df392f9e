"""Makes rank.csv: SciPy's rank statistics, to hold ours against.

Each row is a test: its name, how SciPy computed the p-value, statistic, p-value, and the two
lists of values, separated by spaces.

    pip install "scipy==1.17.1" "numpy==2.4.6"
    python rank.py > rank.csv
"""
import numpy as np
import scipy
from scipy.stats import permutation_test, spearmanr

rng = np.random.default_rng(11)


def row(name, method, statistic, p_value, x, y):
    values = [" ".join(repr(float(v)) for v in part) for part in (x, y)]
    print(",".join([name, method, repr(float(statistic)), repr(float(p_value)), *values]))


def pairs(n, ties, strength):
    x = rng.normal(size=n)
    y = strength * x + rng.normal(size=n)
    return (np.round(x), np.round(y)) if ties else (np.round(x, 4), np.round(y, 4))


print(f"# scipy {scipy.__version__}, numpy {np.__version__}: spearmanr, permutation_test")
print("test,method,statistic,p_value,x,y")
for n in (4, 5, 6):
    for ties in (False, True):
        x, y = pairs(n, ties, 1.0)
        exact = permutation_test((x,), lambda x: abs(spearmanr(x, y).statistic), vectorized=False,
                                 permutation_type="pairings", alternative="greater", n_resamples=np.inf)
        row("spearman", "permutation", spearmanr(x, y).statistic, exact.pvalue, x, y)
for n in (10, 11, 25, 80, 300):
    for ties in (False, True):
        for strength in (0.0, 0.5, 5.0):
            x, y = pairs(n, ties, strength)
            result = spearmanr(x, y)
            row("spearman", "t", result.statistic, result.pvalue, x, y)
