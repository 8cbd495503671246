# Scenarios: truth, configuration and run 0 of each. Other runs are made again from their named streams where they are used.


# No rule compiles the kernels ahead of the fan-out. Two jobs that start together compile the same kernels twice, but
# the second core had nothing else to do; Numba writes its cache files atomically and every later job finds them.
rule simulate:
    input:
        lambda wildcards: LAYOUT.inputs(
            PAPERS[wildcards.paper], [PAPERS[wildcards.paper].jobs[wildcards.job]]
        ),
    output:
        f"{LAYOUT.build}/{{paper}}/simulate/{{job}}.parquet",
        f"{LAYOUT.build}/{{paper}}/simulate/{{job}}.npz",
    params:
        paper="{paper}",
        source=lambda wildcards: SOURCES[wildcards.paper].result(wildcards.job),
    log:
        f"{LAYOUT.build}/logs/{{paper}}/simulate/{{job}}.log",
    conda:
        "../envs/robins.yaml"
    script:
        "../scripts/compute.py"
