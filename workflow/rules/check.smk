# Does the code still make the versioned tables? The whole workflow once more, in an empty directory, compared cell by
# cell. It has no inputs: a check that first brought the results up to date would compare them with themselves.


rule check:
    params:
        python=sys.executable,
        ensemble=LAYOUT.ensemble,
        root=ROOT,
        config=[f"recordings={CONFIGURATION.recordings}"] if RECORDING else [],
    log:
        f"{LAYOUT.build}/logs/check.log",
    conda:
        "../envs/robins.yaml"
    threads: 64  # as many as there are cores
    shell:
        "{params.python:q} -m robins.publish.regenerate --ensemble {params.ensemble} --repository {params.root:q}"
        " --cores {threads} --config {params.config:q} 2>&1 | tee {log:q}"
